#pragma once

#include "core/clock.h"
#include "core/result.h"

#include <cstdint>
#include <string>
#include <string_view>

namespace fantascope::show {

// Something that the operator, or whoever acts for the operator, asked for. Value type; lineOf()
// writes it down.
struct Input {
    enum class Kind {
        Go,        // enter the next cue
        Back,      // enter the cue before
        Jump,      // enter cue `cue`, also the one that is running
        Blackout,  // hold pictures and lamps dark, or give them back
        Dark,      // hold them dark, whether they are or not
        Light,     // give them back, whether they are dark or not
        Revise     // go on with cue list `revision`
    };
    // Where it came from.
    enum class Source {
        Start,       // the command line's --from
        Controller,  // a button of the hand controller, number `which`
        Contact,     // Site::contacts[which]
        Terminal,    // a key at the terminal
        Screen,      // a key at a projector's window
        Schedule     // the GOs of a rehearsal without hands
    };
    Time at{};  // show time
    Kind kind = Kind::Go;
    int cue = 0;  // for Jump alone: index into CueList::cues
    Source source = Source::Start;
    int which = 0;
    int revision = 0;  // for Revise alone: a number of InputLog::add
    friend bool operator==(const Input&, const Input&) = default;
};

// What became of an input.
enum class Outcome { Taken, TooSoonAfterCue, AtLastCue, AtFirstCue, NoSuchCue, NoSuchRevision, OtherSite };
// In words for the operator: "taken", "ignored: ...".
std::string_view nameOf(Outcome outcome);

// One line, without its end: show time in nanoseconds, kind, cue (of Revise: the revision), source,
// which: "12500000000 jump 3 terminal 0".
std::string lineOf(const Input& input);
// Reads what lineOf() has written. Error: what is wrong with the line.
Result<Input> inputOf(std::string_view line);

}  // namespace fantascope::show
