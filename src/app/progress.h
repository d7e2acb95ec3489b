#pragma once

#include "core/clock.h"

#include <optional>
#include <ostream>
#include <string>
#include <string_view>

namespace fantascope::app {

// How far a long run has come, for the person who waits: on a terminal one line that is drawn over and over, with a bar, the
// current value and the time left; elsewhere a plain line every two seconds. Thread: one at a time.
class Progress {
public:
    // `out` and `clock` outlive it.
    Progress(std::string label, const Clock& clock, std::ostream& out, bool terminal);
    // Leaves the last line standing.
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    // `done` is the share of the run behind us, 0..1, or nothing where the run has no end; `value` what is worth seeing, as "z
    // 0.0312". Cheap to call often: draws at most ten times a second.
    void update(std::optional<double> done, std::string_view value);

private:
    std::string line(std::optional<double> done, std::string_view value) const;

    const std::string label_;
    const Clock& clock_;
    std::ostream& out_;
    const bool terminal_;
    const Time start_;
    std::optional<Time> drawn_;  // when the last line was
};

// Whether standard error is a terminal; progress goes there, so that standard output stays clean.
bool standardErrorIsTerminal();

}  // namespace fantascope::app
