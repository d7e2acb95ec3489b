#pragma once

#include "theatre/search/pose_search.h"

#include "core/clock.h"

#include <functional>
#include <optional>
#include <string_view>
#include <vector>

namespace fantascope::theatre {

// The progress of the trials of a search.
struct TrialsProgress {
    std::optional<double> share;                // of the whole run, 0 .. 1; none if it has no end
    std::size_t trial = 0;                      // the trial that reports, from 0
    double energy = 0;                          // of that trial
    std::optional<PoseSearch::Quality> best{};  // of the finished trials
    bool isPaused = false;
};

// Callbacks of the trials. They are called from any thread, one at a time.
struct TrialsWatch {
    std::function<void(const TrialsProgress&)> tell{};
    // Asked between two steps of the work. False ends the run. It may block, which pauses all
    // threads; meanwhile it calls `whilePaused` now and then.
    std::function<bool(const std::function<void()>& whilePaused)> goesOn{};
};

// The trials of a search for poses, on several threads, until all are done, the time is over, or
// somebody ends the run. Trials that the time cut short are dropped, and so are all trials numbered
// after the first of them. So another run of `finished` trials with the same seed gives the same
// poses, on any number of threads.
struct PoseTrials {
    struct Options {
        PoseSearch::Options search;
        std::uint64_t seed = 1;
        std::optional<int> trials;         // none: as many as the time allows
        std::optional<double> seconds;     // if neither is given, the run goes on until somebody ends it
        std::optional<double> patience{};  // seconds after which it ends if no trial is satisfactory
        int threads = 1;
    };
    struct Trial : PoseSearch::Trial {
        std::size_t number = 0;  // from 0
        double seconds = 0;
        bool isFinished() const { return reason != PoseSearch::StopReason::Interrupted; }
        // Whether an audience would miss nothing: everyone can hold the pose, and the shadow
        // matches the target.
        bool isSatisfactory() const { return quality.isValid() && quality.iou >= kSatisfactory; }
    };
    static constexpr double kSatisfactory = 0.95;  // intersection over union
    enum class StopReason { Trials, Time, Interrupted };

    // In the order of their numbers, without histories. If no trial finished, the unfinished ones.
    std::vector<Trial> trials;
    std::size_t finished = 0;
    StopReason reason = StopReason::Trials;
    double seconds = 0;  // by the clock of run()

    // Indices of `trials`, valid before invalid, then by intersection over union, then by number.
    std::vector<std::size_t> bestFirst() const;
    const Trial& best() const { return trials[bestFirst()[0]]; }
    // The solutions to choose from, the best first: the best trial, and all valid ones that are
    // satisfactory or within kNearlyAsGood of the best.
    std::vector<const Trial*> accepted() const;
    static constexpr double kNearlyAsGood = 0.02;  // of intersection over union

    // `clock` gives the time that counts as work. It may stop while the run is paused.
    static PoseTrials run(const PoseProblem& problem, const Options& options, const Clock& clock, const TrialsWatch& watch = {});
};

// Whether `a` is better: valid before invalid, then by intersection over union.
bool isBetter(const PoseSearch::Quality& a, const PoseSearch::Quality& b);

std::string_view name(PoseTrials::StopReason reason);

}  // namespace fantascope::theatre
