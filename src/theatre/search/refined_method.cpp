#include "theatre/search/refined_method.h"

#include "theatre/search/streams.h"
#include "theatre/search/workshop.h"

#include "core/random.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace fantascope::theatre {
namespace {

constexpr double kGlobalShare = 0.15;            // share of the evaluations for the global stage, in coarse pixels
constexpr double kCoarseShare = 0.8;             // share up to which coarse pixels are used; the rest uses fine ones
constexpr double kWeak = 0.01, kLessWeak = 0.1;  // stiffness at the beginning and at the end of the global stage
constexpr double kGlobalSigma = 0.5;
constexpr std::array kStiffer = {0.01, 0.03, 0.1};  // while the outline is fitted
constexpr double kHeld = 0.1,
                 kHeldBy = 0.87;  // stiffness at the start of the coarse local search; share of it after which the stiffness is 1
constexpr int kFitSteps = 20, kRefitSteps = 20, kLastFitSteps = 60;
// The temperature of simulated annealing at the beginning, in units of energy, and the factor by
// which it has fallen at the end.
constexpr double kHot = 6, kCool = 0.05;

class TrialRun {
public:
    TrialRun(const PoseProblem& problem, std::uint64_t seed, const PoseSearch::Options& options,
             const PoseSearch::AskStop& askStop)
        : options_(options),
          askStop_(askStop),
          true_(in256Rows(problem)),
          fine_(simpler(true_.problem)),
          coarse_(forFirstLook(fine_.problem)),
          rng_(streamSeed(seed, {Stream::Moves})) {
        trial_.seed = seed;
        trial_.reason = PoseSearch::StopReason::Evaluations;
        trial_.dofs = PoseSearch::start(problem);
    }

    PoseSearch::Trial run() {
        searchGlobally(coarse_);
        stiffen(coarse_);
        searchLocally(coarse_, kCoarseShare, kHeld);
        searchLocally(fine_, 1, 1);
        true_.fit.run(true_.energy, trial_.dofs, kLastFitSteps);
        mend(true_);
        trial_.evaluations = evaluations();
        return std::move(trial_);
    }

private:
    std::int64_t evaluations() const { return true_.evaluations() + fine_.evaluations() + coarse_.evaluations(); }

    bool goesOn(double energy) {
        if (trial_.reason != PoseSearch::StopReason::Interrupted && askStop_ && askStop_({evaluations(), energy}))
            trial_.reason = PoseSearch::StopReason::Interrupted;
        return trial_.reason != PoseSearch::StopReason::Interrupted;
    }

    void searchGlobally(Workshop& shop) {
        std::vector<std::size_t> all(trial_.dofs.size());
        std::iota(all.begin(), all.end(), std::size_t{0});
        const int generations =
            std::max(1, static_cast<int>(kGlobalShare * static_cast<double>(options_.evaluations) / options_.population));
        shop.search.run(shop.energy, trial_.dofs, all,
                        {.sigma = kGlobalSigma,
                         .population = options_.population,
                         .generations = generations,
                         .stiffness = kWeak,
                         .lastStiffness = kLessWeak},
                        rng_, [&] { return goesOn(shop.energy.lastEnergy()); });
    }

    // Fits with ever stiffer physics until all poses are valid.
    void mend(Workshop& shop) {
        for (const double stiffness : kMending) {
            if (trial_.reason == PoseSearch::StopReason::Interrupted || PoseSearch::measure(shop.problem, trial_.dofs).isValid())
                break;
            shop.fit.run(shop.energy, trial_.dofs, kFitSteps, stiffness);
        }
    }

    // Fits the outline first, then with a little stiffer physics.
    void stiffen(Workshop& shop) {
        for (const double stiffness : kStiffer) shop.fit.run(shop.energy, trial_.dofs, kFitSteps, stiffness);
    }

    // Iterated local search until a share of the evaluations is spent. Meanwhile the stiffness of
    // physics rises to 1.
    void searchLocally(Workshop& shop, double share, double firstStiffness) {
        const auto first = evaluations(), last = static_cast<std::int64_t>(share * static_cast<double>(options_.evaluations));
        std::vector<double> here = trial_.dofs, next;
        double best = std::numeric_limits<double>::infinity();
        while (evaluations() < last) {
            const double done = double(evaluations() - first) / double(last - first);
            const double stiffness = std::pow(firstStiffness, std::max(0.0, 1 - done / kHeldBy));
            shop.energy.pose(here, stiffness);
            double current = shop.energy.energy();
            if (!goesOn(current)) break;

            next = here;
            shop.search.disturb(shop.energy, next, rng_, stiffness);
            const double found = shop.fit.run(shop.energy, next, kRefitSteps, stiffness);
            const double progress = double(evaluations()) / double(options_.evaluations);
            const double tolerance = -kHot * std::pow(kCool, progress) * std::log(1 - rng_.uniform());
            if (found < current + tolerance) here = next, current = found;
            // While physics stiffens, energies of different iterations are not comparable: the
            // newest counts as the best.
            if (firstStiffness < 1 || current < best) best = current, trial_.dofs = here;
            trial_.history.push_back(best);
        }
    }

    const PoseSearch::Options& options_;
    const PoseSearch::AskStop& askStop_;
    Workshop true_, fine_, coarse_;
    Rng rng_;
    PoseSearch::Trial trial_;
};

}  // namespace

PoseSearch::Trial refinedMethod(const PoseProblem& problem, std::uint64_t seed, const PoseSearch::Options& options,
                                const PoseSearch::AskStop& askStop) {
    return TrialRun(problem, seed, options, askStop).run();
}

}  // namespace fantascope::theatre
