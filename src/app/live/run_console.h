#pragma once

#include "app/base/terminal_line.h"
#include "app/live/run_report.h"

#include "show/cue.h"
#include "show/show_state.h"

#include "core/clock.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

namespace fantascope::app {

// What the person at the terminal sees of a run at one moment.
struct RunStatus {
    Time showTime{};
    show::Controls controls{};      // with the current cue
    int cues = 0;                   // their number
    show::CueNumber number = 0;     // of the current cue
    std::string cueName, nextName;  // empty: there is none
    std::string nextNote;           // of the next cue; empty: it has none
    std::string loadedName;         // of the cue that GO enters instead; empty: GO enters that one, too
    Time waitLeft{};                // until the current cue begins to change what is seen; 0: it has begun
    Time fadeLeft{};                // until its look is whole; 0: it is
    std::optional<Time> untilNext;  // until the next cue comes by a follow or by the schedule; none: it waits
    struct Side {
        std::string name;
        bool hasKeys = false;               // GO, back and load go to it
        std::string cueName{}, nextName{};  // empty: it is dark; nothing follows by itself
        std::optional<Time> untilNext{};
    };
    std::vector<Side> sides;                // the lists beside the main one
    std::string highlighted;                // the lamp; empty: none
    std::string parked;                     // lamps that stay as they are: "gate, stairs"
    std::string byHand;                     // lamps and relays: "gate 40 %, fog on"
    std::string unwell;                     // devices and parts with a fault: "left, dmx"; empty: all is well
    std::string schedule;                   // what it brings next: "23:00 dark"; empty: nothing
    std::optional<Time> left;               // of the run; none: the run has no length
    bool settingUp = false;                 // the keys are those of setting up
    bool keys = false;                      // somebody can press keys
    std::optional<double> framesPerSecond;  // of all outputs together; none before the first measurement
    std::int64_t lateFrames = 0;
    std::vector<std::pair<std::string, double>> zCamera;  // the newest z of each output; negative: none yet
    std::string said;                                     // news for the operator since the last status
};

// The status in one line of at most `columns` >= 0 columns. If it does not fit, the least important
// parts are left out first: scores and frame rates, then the ends of long names, then countdowns,
// and last the cue's number and a blackout.
std::string statusLine(const RunStatus& status, int columns);

// A summary of the run in one line.
std::string summaryOf(const RunReport& report);

// Reports on a run while it lasts. A terminal shows a permanent status line, with the news above
// it. Any other output, such as a system journal, gets the news, and the status line once a minute.
// Thread: one at a time.
class RunConsole {
public:
    // `clock` and `out` outlive the console. `columns` returns the terminal's present width; empty:
    // `out` is no terminal.
    RunConsole(const Clock& clock, std::ostream& out, std::function<int()> columns);
    void tell(const RunStatus& status);

private:
    const Clock& clock_;
    std::ostream& out_;
    std::optional<TerminalLine> line_;
    std::optional<Time> told_;  // when the line was last drawn, on the clock
};

}  // namespace fantascope::app
