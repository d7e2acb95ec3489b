#include "theatre/search/pose_trials.h"

#include "core/parallel.h"

#include <algorithm>
#include <mutex>
#include <numeric>
#include <utility>

namespace fantascope::theatre {
namespace {

// The state that all threads share. Threads ask one at a time whether their trial goes on, so a
// pause blocks all of them.
class Course {
public:
    Course(const PoseTrials::Options& options, const Clock& clock, const TrialsWatch& watch)
        : options_(options), clock_(clock), watch_(watch), start_(clock.now()) {}

    // Begins the next trial and gives its number; none if there is no further one.
    std::optional<std::size_t> begin() {
        const std::lock_guard lock(mutex_);
        const std::size_t number = began_.size();
        const bool isLast = options_.trials && number == static_cast<std::size_t>(*options_.trials);
        if (isInterrupted_ || isLast || (number > 0 && isTimeUp())) return std::nullopt;
        began_.push_back(worked());
        evaluations_.push_back(0);
        return number;
    }

    bool mustEnd(std::size_t number, const PoseSearch::Progress& now) {
        const std::lock_guard lock(mutex_);
        evaluations_[number] = now.evaluations;
        const auto tell = [&](bool isPaused) {
            if (watch_.tell) watch_.tell({share(), number, now.energy, best_, isPaused});
        };
        if (now.evaluations > 0) tell(false);  // the trial has an energy
        if (!isInterrupted_ && watch_.goesOn) isInterrupted_ = !watch_.goesOn([&] { tell(true); });
        // The time limit does not cut a trial short if a later one has finished.
        return isInterrupted_ || (isTimeUp() && number >= afterFinished_);
    }

    void end(PoseTrials::Trial trial) {
        const std::lock_guard lock(mutex_);
        trial.seconds = fantascope::seconds(worked() - began_[trial.number]);
        trial.history = {};
        evaluations_[trial.number] = trial.evaluations;
        if (trial.isFinished()) {
            isSatisfied_ |= trial.isSatisfactory();
            afterFinished_ = std::max(afterFinished_, trial.number + 1);
            if (!best_ || isBetter(trial.quality, *best_)) best_ = trial.quality;
        }
        trials_.push_back(std::move(trial));
    }

    PoseTrials found() && {
        PoseTrials found;
        found.seconds = fantascope::seconds(worked());
        std::sort(trials_.begin(), trials_.end(), [](const auto& a, const auto& b) { return a.number < b.number; });
        const auto isCut = [](const PoseTrials::Trial& trial) { return !trial.isFinished(); };
        if (isInterrupted_) {
            found.reason = PoseTrials::StopReason::Interrupted;
            found.finished = trials_.size() - static_cast<std::size_t>(std::count_if(trials_.begin(), trials_.end(), isCut));
            if (found.finished > 0) trials_.erase(std::remove_if(trials_.begin(), trials_.end(), isCut), trials_.end());
        } else {
            const auto firstCut = std::find_if(trials_.begin(), trials_.end(), isCut);
            const bool areAll = firstCut == trials_.end() && options_.trials && trials_.size() == std::size_t(*options_.trials);
            found.reason = areAll ? PoseTrials::StopReason::Trials : PoseTrials::StopReason::Time;
            found.finished = static_cast<std::size_t>(firstCut - trials_.begin());
            if (found.finished > 0) trials_.erase(firstCut, trials_.end());
        }
        found.trials = std::move(trials_);
        return found;
    }

private:
    Time worked() const { return clock_.now() - start_; }
    bool isTimeUp() const {
        const double now = fantascope::seconds(worked());
        return (options_.seconds && now >= *options_.seconds) ||
               (options_.patience && now >= *options_.patience && !isSatisfied_);
    }

    // The share of the whole run that is done; none if the run has no end.
    std::optional<double> share() const {
        std::optional<double> done;
        if (options_.seconds && *options_.seconds > 0) done = fantascope::seconds(worked()) / *options_.seconds;
        if (options_.trials) {
            const double planned = double(*options_.trials) * double(options_.search.evaluations);
            done = std::max(done.value_or(0),
                            double(std::accumulate(evaluations_.begin(), evaluations_.end(), std::int64_t{0})) / planned);
        }
        return done;
    }

    const PoseTrials::Options& options_;
    const Clock& clock_;
    const TrialsWatch& watch_;
    std::mutex mutex_;  // guards all that follows
    const Time start_;
    bool isInterrupted_ = false;
    std::vector<Time> began_;                // of each trial
    std::vector<std::int64_t> evaluations_;  // of each so far
    std::size_t afterFinished_ = 0;          // one more than the highest number of a finished trial
    std::optional<PoseSearch::Quality> best_;
    bool isSatisfied_ = false;
    std::vector<PoseTrials::Trial> trials_;  // ended, finished or not
};

}  // namespace

bool isBetter(const PoseSearch::Quality& a, const PoseSearch::Quality& b) {
    return std::pair(a.isValid(), a.iou) > std::pair(b.isValid(), b.iou);
}

std::string_view name(PoseTrials::StopReason reason) {
    switch (reason) {
        case PoseTrials::StopReason::Trials:
            return "trials";
        case PoseTrials::StopReason::Time:
            return "time";
        case PoseTrials::StopReason::Interrupted:
            return "interrupted";
    }
    return "";
}

std::vector<std::size_t> PoseTrials::bestFirst() const {
    std::vector<std::size_t> order(trials.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return isBetter(trials[a].quality, trials[b].quality); });
    return order;
}

std::vector<const PoseTrials::Trial*> PoseTrials::accepted() const {
    std::vector<const Trial*> accepted;
    for (const std::size_t i : bestFirst()) {
        const Trial& trial = trials[i];
        const bool isGood = trial.isSatisfactory() || (trial.quality.isValid() && !accepted.empty() &&
                                                       trial.quality.iou >= accepted[0]->quality.iou - kNearlyAsGood);
        if (accepted.empty() || isGood) accepted.push_back(&trial);
    }
    return accepted;
}

PoseTrials PoseTrials::run(const PoseProblem& problem, const Options& options, const Clock& clock, const TrialsWatch& watch) {
    Course course(options, clock, watch);
    parallelFor(options.threads, options.threads, [&](int) {
        while (const std::optional<std::size_t> number = course.begin()) {
            Trial trial;
            static_cast<PoseSearch::Trial&>(trial) =
                PoseSearch::run(problem, PoseSearch::trialSeed(options.seed, *number), options.search,
                                [&](const PoseSearch::Progress& now) { return course.mustEnd(*number, now); });
            trial.number = *number;
            course.end(std::move(trial));
        }
    });
    return std::move(course).found();
}

}  // namespace fantascope::theatre
