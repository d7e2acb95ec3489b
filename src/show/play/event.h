#pragma once

#include "show/cue.h"
#include "show/play/input_log.h"

#include "core/append_log.h"
#include "core/clock.h"

#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace fantascope::show {

// What happens while a show runs.
namespace event {

// The log took an input, or ignored it.
struct InputDecided {
    LoggedInput input;
};
// A cue was entered, by an input or by a follow.
struct CueEntered {
    int cue = 0;  // index into Show::cues, of `cues`; -1: the dark before the first
    int cues = 0;
    std::string name;
    CueNumber number = 0;
    std::string list{};  // the side list; empty: the main one
};
// The operator holds the show in some way, or lets it go.
struct HoldChanged {
    Hold hold = Hold::Blackout;
    bool on = false;
};
struct MasterChanged {
    float level = 1;
};
// A lamp is shown at full, or at another level, or another one, or none, for who focuses it.
struct LampHighlighted {
    std::string lamp;   // empty: none
    bool solo = false;  // nothing is shown but that one
    float level = 1;
};
// A lamp stays as it is, or follows the cues again.
struct LampParked {
    std::string lamp;
    bool parked = false;
};
// A lamp shines at least so bright by hand, or is left to the cues.
struct LampRaised {
    std::string lamp;
    float level = 0;  // 0: it is left to them
};
// A relay is as a person has it, or as the cues have it.
struct RelaySwitched {
    std::string relay;
    std::optional<bool> on;  // nothing: as the cues have it
};
// The key that switches a relay is for another one.
struct RelayChosen {
    std::string relay;  // empty: none
    std::string key;
};
// The page of the run is there.
struct PageOpened {
    std::string address;  // for a browser on this machine
};
// GO is to enter another cue than the one after the current.
struct CueLoaded {
    int cue = -1;  // index into Show::cues, of `cues`; -1: the next one, as usual
    int cues = 0;
    std::string name;
    CueNumber number = 0;
    std::string list{};  // the side list; empty: the main one
};
// The keys for cues go to another list.
struct ListChosen {
    std::string list;  // the side list; empty: the main one
};
// The run goes on with what an earlier one has left in the journal.
struct ShowResumed {
    std::string cue;          // that is on; empty: none
    bool isExact = true;      // its fades, waits and follows go on, too
    std::size_t damaged = 0;  // lines of the journal
};
// The show's schedule enters a cue, or lets it get dark.
struct ScheduleCalled {
    std::string what;    // "'Night' since 21:15"
    bool joins = false;  // the cue was to be entered earlier
};
// What the show's schedule brings in the next 24 hours.
struct NextDayTold {
    std::string lines;
};
// The machine's clock was set.
struct ClockSet {
    std::string now;  // what it shows
    Time by{};        // forward
};
// A person took over from the schedule of a rehearsal.
struct ScheduleEnded {};
// Somebody pressed the key that ends the run. The run ends if it is pressed again within
// `patience`.
struct QuitAsked {
    std::string key;
    Time patience{};
};
// Somebody wants to know the keys.
struct KeysAsked {
    std::string keys;  // a line for each
};
// How the show is: what is dark and why, what is not well.
struct StateTold {
    std::string lines;
};
// A fault began, or its reason changed.
struct FaultBegan {
    std::string device;  // by its name in the site file; empty: none
    std::string what;
};
struct FaultEnded {
    std::string device;
    std::string news;  // empty: the operator is not told
    Time lasted{};     // on the machine's clock
};
// The senders of a universe changed.
struct SendersChanged {
    int universe = 0;
    std::vector<std::string> senders;  // the senders in charge, at least one; "" is the show, which comes first
};
struct PictureTaken {
    std::filesystem::path file;
};
struct PictureMissed {
    std::string why;
};
// The camera sees that an output's projector has moved.
struct PictureMoved {
    std::string output;
    double px = 0;  // how far, rms over the picture, projector pixels
};
// The camera sees that it has moved itself.
struct CameraMoved {};
// The camera sees a movement, but not whether it or a projector has moved.
struct MovementUnclear {};
// The camera sees why the wall is not as it should be, or why it cannot tell.
struct CauseBegan {
    std::string output;  // empty: all of them
    std::string cause;   // as in the report
    std::string advice;  // what is seen, and what to do
};
struct CauseEnded {
    std::string output, cause;
};
// Ambient light makes the site's lamps give less, or give more again; or could.
struct LampsTrimmed {
    std::string why;               // what the camera sees
    double share = 1;              // of the fixtures' levels, to which they go
    std::vector<std::string> off;  // relays that are off
    bool applied = false;          // false: advice
};
// What the light correction does with a canvas, or would do.
struct LightCorrected {
    std::string canvas;
    double kept = 1;                    // share of a white canvas's light that is left
    double tooDark = 0, tooBright = 0;  // shares of its places that stay darker, brighter than the others
    bool applied = false;               // false: advice
    std::string trouble;                // why there is none; empty: there is one
};
// How much better a source's pattern would read on the wall, or reads from now on.
struct PatternFitted {
    std::string source;
    double toneBefore = 0, toneAfter = 0;            // difference from the guide, seen from afar, of full light
    double kept = 1;                                 // share of the picture's light that is left
    std::size_t made = 0, removed = 0, changed = 0;  // instances
    bool applied = false;                            // false: advice
};
// The show was saved, or files of its sources, and goes on with what is new.
struct ShowRevised {
    std::string files;
    std::string news{};  // "; ..." of what came of them
};
// Something was saved that cannot be taken over.
struct RevisionRefused {
    std::string files;
    std::string why;  // may have several lines
};
// The site file was saved, and a part of it counts only when the show begins anew.
struct SiteChanged {
    std::filesystem::path file;
    std::string later;  // keys
};
// The site file was saved, and outputs show their pictures as it says.
struct SiteAdopted {
    std::filesystem::path file;
    std::string outputs;
};
struct SettingUpBegan {};
struct SettingUpEnded {
    bool saved = false;
};
struct SiteSaved {
    std::filesystem::path file, previous;
};
struct SiteNotSaved {
    std::string why;
};

using What = std::variant<InputDecided, CueEntered, HoldChanged, MasterChanged, LampHighlighted, LampParked, LampRaised,
                          RelaySwitched, RelayChosen, PageOpened, CueLoaded, ListChosen, ShowResumed, ScheduleCalled, NextDayTold,
                          ClockSet, ScheduleEnded, QuitAsked, KeysAsked, StateTold, FaultBegan, FaultEnded, SendersChanged,
                          PictureTaken, PictureMissed, LightCorrected, PictureMoved, CameraMoved, MovementUnclear, CauseBegan,
                          CauseEnded, PatternFitted, LampsTrimmed, ShowRevised, RevisionRefused, SiteChanged, SiteAdopted,
                          SettingUpBegan, SettingUpEnded, SiteSaved, SiteNotSaved>;

}  // namespace event

struct Event {
    Time at{};  // show time
    event::What what;
};

// All events of a run in one order. Terminal, report and console have a reader each.
using EventLog = AppendLog<Event>;

// "universe 1 is now sent by the show and 'FOH'".
std::string sentenceOf(const event::SendersChanged& change);
// What the operator is told, without a full stop. Empty: the operator is told nothing. An input
// that was taken has no sentence, nor has a universe that a desk takes over: that is a fault, which
// has its own event.
std::string sentenceOf(const Event& event);

}  // namespace fantascope::show
