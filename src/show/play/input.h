#pragma once

#include "show/course/lamp_trim.h"
#include "show/course/picture_shift.h"

#include "core/clock.h"
#include "core/result.h"

#include <cstdint>
#include <string>
#include <string_view>

namespace fantascope::show {

// What the operator, or something that acts for the operator, asks of a running show. Value type;
// lineOf() writes it as text.
struct Input {
    enum class Kind {
        Go,           // enter the next cue
        Back,         // enter the cue before
        Jump,         // enter cue `cue`, also if it is the current one; -1: the dark before the first
        Blackout,     // toggle the blackout of pictures and fixtures
        Dark,         // begin the blackout, if there is none
        Light,        // end the blackout, if there is one
        Revise,       // continue with cue list `revision`
        Correct,      // move the picture of output `which` to `shift`
        Exchange,     // exchange `revision` of the source with the id `which` (PatternCourses)
        Corrections,  // toggle: take all corrections back and ignore further ones, or allow them again
        Trim,         // trim the site's lamps to `trim`
        Lock,         // toggle: ignore hand controller, contacts and windows but for darkness, or take them again
        Load,         // let GO enter cue `cue`; -1: the cue after the current one
        Pause,        // toggle: let the cues' time stand still, or go on
        Freeze,       // toggle: keep what is seen, or show the cues again
        Panic,        // make all dark and safe within the show's `panicFade`; again: at once
        Restore,      // end the panic: everything goes on from where it was
        Master,       // dim pictures and fixtures to `level`
        Highlight,    // show fixture `fixture` at full; -1: none
        Solo,         // toggle: show nothing but that fixture, or all again
        Level,        // show the highlighted fixture at `level`
        Park,         // toggle: keep fixture `fixture` as it is seen, or let it go
        Raise,        // let fixture `fixture` shine at `level` at least; 0: as the cues have it
        Switch,       // switch relay `relay` to `on`, until a cue switches it
        Release       // take back all that was raised or switched
    };
    // Where the input came from.
    enum class Source {
        Start,       // the command line's --from, or the show's own start
        Controller,  // a button of the hand controller, number `which`
        Contact,     // Site::contacts[which]
        Terminal,    // a key at the terminal
        Screen,      // a key at a projector's window
        Schedule,    // the show's schedule, or GO by that of a rehearsal without an operator
        Camera,      // what the camera sees; of Correct: on output `which`; of Exchange: of source `which`
        Journal,     // what an earlier run has left, where its journal is damaged
        File,        // a file of the show that was saved
        Page         // the page that the program serves, or a script
    };
    Time at{};  // show time
    Kind kind = Kind::Go;
    int cue = 0;  // for Jump and Load: index into CueList::cues
    Source source = Source::Start;
    int which = 0;
    int revision = 0;      // for Revise: a number that InputLog::add() returned; for Exchange: that of the exchange
    PictureShift shift{};  // only for Correct
    LampTrim trim{};       // only for Trim
    float level = 1;       // for Master, Level and Raise, 0..1
    Time ago{};            // for Jump: the cue was to be entered so long before; what has followed by now is entered
    int fixture = -1;      // for Highlight, Park and Raise: index into Site::fixtures
    int list = 0;          // for Go, Back, Jump and Load: the list; 0: the main one, else that of CueList::sides, from 1
    bool late = false;     // a person asked for it so long before it was taken that it may not be wanted any more
    int relay = -1;        // for Switch: index into Site::relays
    bool on = false;       // for Switch
    friend bool operator==(const Input&, const Input&) = default;
};

// What became of an input.
enum class Outcome {
    Taken,
    TooSoonAfterCue,
    AtLastCue,
    AtFirstCue,
    NoSuchCue,
    NoSuchRevision,
    OtherSite,
    NoSuchOutput,
    NoSuchPattern,
    TooFar,
    CorrectionsOff,
    RelaysHeld,
    Locked,
    Panicked,
    NothingToRestore,
    TooLate,
    NoSuchLevel,
    NoSuchList,
    OtherLists,
    NoSuchFixture,
    NoSuchRelay
};
// The outcome in words for the operator: "taken", "ignored: ...".
std::string_view nameOf(Outcome outcome);
// As in a line: "go", "controller".
std::string_view nameOf(Input::Kind kind);
std::string_view nameOf(Input::Source source);

// One line, without its end: show time in nanoseconds, kind, cue (of Revise and Exchange: the
// revision; of Highlight, Park and Raise: the fixture; of Switch: the relay), source, which, of
// Correct also the shift, of Trim also the share and how many relays are off, of Master, Level and
// Raise also the level, of Switch also 1 for on; "list" and its number unless it is the main one;
// and "late" if it is: "12500000000 jump 3 terminal 0".
std::string lineOf(const Input& input);
// Reads a line that lineOf() wrote. Error: what is wrong with the line.
Result<Input> inputOf(std::string_view line);

}  // namespace fantascope::show
