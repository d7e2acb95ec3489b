#pragma once

#include "app/base/terminal_line.h"

#include "core/clock.h"

#include <functional>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>

namespace fantascope::app {

// How far a long computation has come, for the person who waits: on a terminal one line that is
// drawn over and over, with a bar where there is room, the current value and the time left;
// elsewhere a plain line every two seconds. It goes to standard error, so that standard output
// stays clean. Thread: one at a time.
class Progress {
public:
    // `out` and `clock` outlive it; `columns`: of the terminal, where it is one.
    Progress(std::string label, const Clock& clock, std::ostream& out, bool terminal,
             std::function<int()> columns = standardErrorColumns);

    // `done` is the share of the run behind us, 0..1, or nothing where the run has no end; `value`
    // what is worth seeing, as "z 0.0312". Cheap to call often: draws at most ten times a second.
    void update(std::optional<double> done, std::string_view value);

private:
    std::string line(std::optional<double> done, std::string_view value) const;

    const std::string label_;
    const Clock& clock_;
    std::ostream& out_;
    std::optional<TerminalLine> terminal_;
    const Time start_;
    std::optional<Time> drawn_;  // when the last line was
};

}  // namespace fantascope::app
