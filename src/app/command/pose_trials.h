#pragma once

#include "theatre/search/pose_search.h"

#include "core/clock.h"

#include <iosfwd>
#include <optional>
#include <string_view>
#include <vector>

namespace fantascope::app {

// The trials of a search for poses, on several threads, until all are done, the time is over, or a
// person ends it; a person may also pause it. Those that the time cut short are dropped, and so is
// what came after the first of them: `finished` trials of the same seed give the same poses again,
// on any number of threads.
struct PoseTrials {
    struct Options {
        theatre::PoseSearch::Options search;
        std::uint64_t seed = 1;
        std::optional<int> trials;         // as many as fit into the time without
        std::optional<double> seconds;     // without either it goes on until a person ends it
        std::optional<double> patience{};  // seconds after which it ends if no trial is satisfactory
        int threads = 1;
    };
    struct Trial : theatre::PoseSearch::Trial {
        std::size_t number = 0;  // from 0
        double seconds = 0;
        bool isFinished() const { return reason != theatre::PoseSearch::StopReason::Interrupted; }
        // Nothing is missing for an audience: everyone can hold the pose, and the shadow is the
        // target's.
        bool isSatisfactory() const { return quality.isValid() && quality.iou >= kSatisfactory; }
    };
    static constexpr double kSatisfactory = 0.95;  // intersection over union
    enum class StopReason { Trials, Time, Interrupted };

    // In the order of their numbers, without their histories. Where none finished, those that did
    // not.
    std::vector<Trial> trials;
    std::size_t finished = 0;
    StopReason reason = StopReason::Trials;
    double seconds = 0;  // without pauses

    // Valid before invalid, then by intersection over union, then by number.
    std::vector<std::size_t> bestFirst() const;

    // `progress`: where lines of progress go; `terminal`: it is one. Thread: one at a time, as it
    // listens to Ctrl-C.
    static PoseTrials run(const theatre::PoseProblem& problem, const Options& options, Clock& clock, std::ostream& progress,
                          bool terminal);
};

// Valid before invalid, then by intersection over union.
bool isBetter(const theatre::PoseSearch::Quality& a, const theatre::PoseSearch::Quality& b);

std::string_view name(PoseTrials::StopReason reason);

}  // namespace fantascope::app
