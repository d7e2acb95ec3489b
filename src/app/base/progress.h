#pragma once

#include "app/base/terminal_line.h"

#include "core/clock.h"

#include <functional>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>

namespace fantascope::app {

// The progress of a long computation. On a terminal it is one line that is redrawn, with a bar if
// there is room, the current value and the time left. Elsewhere it is a plain line every two
// seconds. It goes to standard error, so that standard output stays clean. Thread: one at a time.
class Progress {
public:
    // `out` and `clock` outlive it. `columns`: width of the terminal, if `terminal`.
    Progress(std::string label, const Clock& clock, std::ostream& out, bool terminal,
             std::function<int()> columns = standardErrorColumns);

    // `done`: finished share of the run, 0..1; nothing if the run has no end. `value`: the figure
    // to show, such as "z 0.0312". Cheap to call often: it draws at most ten times a second.
    void update(std::optional<double> done, std::string_view value);

private:
    std::string line(std::optional<double> done, std::string_view value) const;

    const std::string label_;
    const Clock& clock_;
    std::ostream& out_;
    std::optional<TerminalLine> terminal_;
    const Time start_;
    std::optional<Time> drawn_;  // time of the last line
};

}  // namespace fantascope::app
