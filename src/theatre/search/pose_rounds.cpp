#include "theatre/search/pose_rounds.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace fantascope::theatre {
namespace {

// The number of evaluations of a trial that a thread finishes within the time, but no more than a
// trial needs. The report states this number, so that --evaluations can repeat the run.
std::int64_t evaluationsWithin(double seconds, PoseSearch::Options options, const PoseProblem& problem, std::uint64_t seed,
                               const Clock& clock) {
    constexpr std::int64_t kProbe = 1500;
    constexpr double kSpare = 0.74;  // reserve, since threads slow each other down
    const std::int64_t enough = std::exchange(options.evaluations, kProbe);
    // The time of an evaluation is measured between the probe's first and last question. The
    // beginning and the end of a trial cost a fixed time on top.
    struct Look {
        std::int64_t evaluations = 0;
        Time at{};
    };
    std::optional<Look> first;
    Look last;
    const Time start = clock.now();
    PoseSearch::run(problem, seed, options, [&](const PoseSearch::Progress& now) {
        last = {now.evaluations, clock.now()};
        if (!first) first = last;
        return false;
    });
    const double took = fantascope::seconds(clock.now() - start), searching = fantascope::seconds(last.at - first->at);
    const double each = searching / static_cast<double>(std::max<std::int64_t>(1, last.evaluations - first->evaluations));
    const double fit = kSpare * (seconds - took - (took - searching)) / std::max(each, 1e-6);
    return static_cast<std::int64_t>(std::clamp(fit, 1000.0, static_cast<double>(enough)));
}

// Runs the trials of one round until `seconds` after `start`, if given. Unless `isLast`, the round
// stops after half of the remaining time if no trial is satisfactory.
Result<PoseRounds::Round> searchWith(const PoseRounds::Options& options, PoseProblem problem, std::optional<double> seconds,
                                     bool isLast, const Clock& clock, Time start, const TrialsWatch& watch) {
    problem.buildSkins();
    PoseTrials::Options trials{options.search, options.seed, options.trials, seconds, {}, options.threads};
    const bool isShort = problem.actors.size() <= std::size_t{PoseRounds::kFewActors} && problem.targets.size() == 1;
    trials.search.evaluations =
        options.evaluations.value_or(isShort ? PoseRounds::kEvaluationsOfFew : PoseRounds::kEvaluationsOfMany);
    TRY(trials.search.check());
    if (seconds) {
        const auto left = [&] { return std::max(0.0, *seconds - fantascope::seconds(clock.now() - start)); };
        const double share = isLast ? 1 : 0.5;
        if (!options.evaluations)
            trials.search.evaluations = evaluationsWithin(share * left(), trials.search, problem, options.seed, clock);
        trials.seconds = left();
        if (!isLast) trials.patience = share * left();
    }
    PoseRounds::Round round{std::move(problem), trials.search.evaluations, {}};
    round.trials = PoseTrials::run(round.problem, trials, clock, watch);
    return round;
}

}  // namespace

Result<PoseRounds> PoseRounds::run(const Task& task, const Options& options, const Clock& clock, Time start, const Watch& watch) {
    std::optional<double> seconds = options.seconds;
    if (!options.trials && !seconds) seconds = kDefaultSeconds;
    PoseRounds found;
    for (int more = 0; more <= options.mostMore; ++more) {
        Result<Troupe> troupe = task.troupe;
        if (more > 0)
            troupe =
                Troupe::of(task.area, static_cast<int>(task.troupe.statures.size()) + more, task.troupe.height, task.statures);
        if (!troupe) break;  // each would have too little of the silhouette
        TRY(task.stage.checkHolders(troupe->statures.size()));
        PoseProblem problem{task.stage, task.targets, {}, task.weights, {}, task.hints, {}};
        for (const double stature : troupe->statures) problem.actors.push_back(humanBody(stature));
        if (watch.begins) watch.begins();
        const bool isLast = more == options.mostMore;
        found.rounds.push_back(TRY(searchWith(options, std::move(problem), seconds, isLast, clock, start, watch)));
        const Round& round = found.rounds.back();
        if (round.best().isSatisfactory() || round.trials.reason == PoseTrials::StopReason::Interrupted) break;
        if (!isLast && watch.notEnough) watch.notEnough(round);
    }
    const auto best = std::max_element(found.rounds.begin(), found.rounds.end(), [](const Round& a, const Round& b) {
        return isBetter(b.best().quality, a.best().quality);
    });
    std::rotate(best, best + 1, found.rounds.end());
    return found;
}

}  // namespace fantascope::theatre
