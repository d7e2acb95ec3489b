#pragma once

#include "theatre/search/pose_trials.h"
#include "theatre/search/troupe.h"

#include <functional>
#include <optional>
#include <vector>

namespace fantascope::theatre {

// The search for poses with as many actors as it takes (Won & Lee 2016, section 4): the last resort
// is one more actor, with whom the search starts anew. A round is the set of trials with one number
// of actors.
struct PoseRounds {
    struct Task {
        Stage stage;
        std::vector<PoseTarget> targets;  // of each beam of the stage
        PoseWeights weights;
        std::vector<PoseHint> hints;
        double area = 0;               // as for Troupe::of()
        Troupe troupe;                 // of the first round
        std::vector<double> statures;  // as for Troupe::of()
    };
    struct Options {
        PoseSearch::Options search{};               // its evaluations are set by each round
        std::optional<std::int64_t> evaluations{};  // of a trial; none: chosen by the number of actors and the time
        std::uint64_t seed = 1;
        std::optional<int> trials{};      // of a round
        std::optional<double> seconds{};  // of all rounds; with neither trials nor seconds kDefaultSeconds
        int mostMore = 0;                 // actors that may be added, one a round: 0 .. kMostMore
        int threads = 1;
    };
    static constexpr int kMostMore = 2;
    static constexpr double kDefaultSeconds = 20;
    static constexpr int kFewActors = 3;  // up to this many actors and with one target, a trial is shorter
    static constexpr std::int64_t kEvaluationsOfFew = 40'000, kEvaluationsOfMany = 80'000;

    struct Round {
        PoseProblem problem;
        std::int64_t evaluationsPerTrial = 0;
        PoseTrials trials;
        const PoseTrials::Trial& best() const { return trials.best(); }
    };
    struct Watch : TrialsWatch {
        std::function<void()> begins{};                 // a round begins
        std::function<void(const Round&)> notEnough{};  // no trial was satisfactory, so one more actor comes in
    };

    std::vector<Round> rounds;  // the best last

    // `clock`: as for PoseTrials::run(). `start`: when the time began to count. A round that is not
    // the last has half of the remaining time, or all of it if it finds a satisfactory trial.
    // Error: a prop's holder is not among the actors, or an option is out of range.
    static Result<PoseRounds> run(const Task& task, const Options& options, const Clock& clock, Time start, const Watch& watch);
};

}  // namespace fantascope::theatre
