#pragma once

#include "app/base/terminal_line.h"
#include "app/live/run_report.h"

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
    int cue = -1, cues = 0;                 // the number of the one that is on, from 0; -1 before the first
    std::string cueName, nextName;          // empty: there is none
    Time fadeLeft{};                        // 0: nothing fades
    std::optional<Time> untilNext;          // until the next cue comes without a person
    std::optional<Time> left;               // of the run, where it has a length
    bool blackout = false;                  // pictures and lamps are held dark
    bool settingUp = false;                 // the keys are those of the outputs' setting up
    bool keys = false;                      // somebody may press some
    std::optional<double> framesPerSecond;  // of all outputs together; none before it was measured
    std::int64_t lateFrames = 0;
    std::vector<std::pair<std::string, double>> zCamera;  // the newest of each output; negative: none yet
    std::string said;                                     // news for the operator since the last status
};

// The status in one line of at most so many columns. Where it does not fit, what matters least goes
// first: scores and frame rates, then the ends of long names, then countdowns; last go the cue's
// number and a blackout. columns >= 0.
std::string statusLine(const RunStatus& status, int columns);

// What is worth saying once the run is over.
std::string summaryOf(const RunReport& report);

// Tells of a run while it lasts. On a terminal: one line that is always there, and above it the
// news. Elsewhere, as in a journal: the news, and the line once a minute. Thread: one at a time.
class RunConsole {
public:
    // `clock` and `out` outlive it; `columns`: of the terminal, asked again and again; none: it is
    // no terminal.
    RunConsole(const Clock& clock, std::ostream& out, std::function<int()> columns);
    void tell(const RunStatus& status);

private:
    const Clock& clock_;
    std::ostream& out_;
    std::optional<TerminalLine> line_;
    std::optional<Time> told_;  // when the line was, on the clock
};

}  // namespace fantascope::app
