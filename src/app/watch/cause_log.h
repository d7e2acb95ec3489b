#pragma once

#include "core/clock.h"

#include <algorithm>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace fantascope::app {

// Why the wall was not as it should be.
struct CauseReport {
    std::string output;        // empty: all of them
    Time from{};               // show time
    std::optional<Time> to{};  // none: until the end
    std::string cause;
};

// The causes that were named, in the order in which they were noticed. Thread: thread-bound.
class CauseLog {
public:
    const std::vector<CauseReport>& all() const { return all_; }

    bool isOpen(const std::string& output, const std::string& cause) const {
        return std::ranges::any_of(all_, [&](const CauseReport& report) { return isIt(report, output, cause); });
    }
    // Whether any cause is open, of an output or, with an empty name, of all, except some.
    bool isAnyOpen(const std::string& output, const std::set<std::string>& except) const {
        return std::ranges::any_of(all_, [&](const CauseReport& report) {
            return !report.to && report.output == output && !except.contains(report.cause);
        });
    }
    // Does nothing if it is open.
    void begin(std::string output, std::string cause, Time from) {
        if (!isOpen(output, cause)) all_.push_back({std::move(output), from, {}, std::move(cause)});
    }
    // Does nothing unless it is open.
    void end(const std::string& output, const std::string& cause, Time to) {
        for (CauseReport& report : all_)
            if (isIt(report, output, cause)) report.to = to;
    }

private:
    static bool isIt(const CauseReport& report, const std::string& output, const std::string& cause) {
        return !report.to && report.output == output && report.cause == cause;
    }
    std::vector<CauseReport> all_;
};

}  // namespace fantascope::app
