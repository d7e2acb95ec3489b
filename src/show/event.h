#pragma once

#include "show/input_log.h"

#include "core/append_log.h"
#include "core/clock.h"

#include <filesystem>
#include <string>
#include <variant>
#include <vector>

namespace fantascope::show {

// What happens while a show runs.
namespace event {

// An input was taken, or ignored.
struct InputDecided {
    LoggedInput input;
};
// By an input or by itself.
struct CueEntered {
    int cue = 0;  // index into Show::cues, of `cues`
    int cues = 0;
    std::string name;
};
struct BlackoutChanged {
    bool dark = false;
};
// A person took over from the schedule of a rehearsal.
struct ScheduleEnded {};
// The key that ends the run was pressed; it must be pressed again within `patience`.
struct QuitAsked {
    std::string key;
    Time patience{};
};
// Something fails, or fails otherwise than before.
struct FaultBegan {
    std::string device;  // by its name in the site file; empty: none
    std::string what;
};
struct FaultEnded {
    std::string device;
    std::string news;  // empty: nobody is told
    Time lasted{};     // on the machine's clock
};
// Somebody else sends a universe now.
struct SendersChanged {
    int universe = 0;
    std::vector<std::string> senders;  // at least one, the first in charge; "": the show
};
struct PictureTaken {
    std::filesystem::path file;
};
struct PictureMissed {
    std::string why;
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

using What = std::variant<InputDecided, CueEntered, BlackoutChanged, ScheduleEnded, QuitAsked, FaultBegan, FaultEnded,
                          SendersChanged, PictureTaken, PictureMissed, SettingUpBegan, SettingUpEnded, SiteSaved, SiteNotSaved>;

}  // namespace event

struct Event {
    Time at{};  // show time
    event::What what;
};

// All events of a run in one order. Whoever wants to know has a reader of its own: terminal,
// report, console.
using EventLog = AppendLog<Event>;

// "universe 1 is now sent by 'FOH' and the show".
std::string sentenceOf(const event::SendersChanged& change);
// What the operator is told, without a full stop; empty: nothing, as of an input that was taken or
// a universe that a desk takes, which is a fault of its own.
std::string sentenceOf(const Event& event);

}  // namespace fantascope::show
