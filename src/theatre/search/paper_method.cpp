#include "theatre/search/paper_method.h"

#include "theatre/energy/scene_energy.h"
#include "theatre/search/artefacts.h"
#include "theatre/search/dof_search.h"
#include "theatre/search/streams.h"

#include "core/random.h"

#include <algorithm>
#include <numeric>
#include <vector>

namespace fantascope::theatre {
namespace {

constexpr double kGlobalShare = 0.85;  // share of the evaluations for the search over all degrees of freedom
constexpr double kSigma = 0.5, kRefinedSigma = 0.3;
constexpr int kRefinedGenerations = 25;
constexpr double kPapersStiffness = 0.1;  // stiffness of physics at first, as in Table 1; refinement uses 1
constexpr double kConverged = 0.1;        // smaller differences of energy are invisible

class TrialRun {
public:
    TrialRun(const PoseProblem& problem, std::uint64_t seed, const PoseSearch::Options& options,
             const PoseSearch::AskStop& askStop)
        : options_(options), askStop_(askStop), fine_(simpler(in256Rows(problem))), rng_(streamSeed(seed, {Stream::Moves})) {
        trial_.seed = seed;
        trial_.dofs = PoseSearch::start(problem);
    }

    PoseSearch::Trial run() {
        trial_.reason = PoseSearch::StopReason::Evaluations;
        searchAll(forFirstLook(fine_));
        refine(fine_);
        return std::move(trial_);
    }

private:
    bool goesOn(double energy) {
        if (askStop_ && askStop_({trial_.evaluations, energy})) trial_.reason = PoseSearch::StopReason::Interrupted;
        return trial_.reason != PoseSearch::StopReason::Interrupted;
    }

    // CMA-ES over the degrees of freedom in `which`, starting from `dofs`.
    double search(const PoseProblem& problem, SceneEnergy& energy, std::vector<double>& dofs, const Dofs& which, double sigma,
                  double stiffness, std::int64_t evaluations) {
        DofSearch search(problem);
        const auto generations = static_cast<int>(std::max<std::int64_t>(1, evaluations / options_.population));
        const double found = search.run(energy, dofs, which,
                                        {sigma, options_.population, generations, kConverged, options_.fullCovariance, stiffness},
                                        rng_, [&] { return goesOn(energy.lastEnergy()); });
        trial_.evaluations += search.evaluations();
        return found;
    }

    void searchAll(const PoseProblem& problem) {
        SceneEnergy energy(problem);
        Dofs all(trial_.dofs.size());
        std::iota(all.begin(), all.end(), std::size_t{0});
        search(problem, energy, trial_.dofs, all, kSigma, kPapersStiffness,
               static_cast<std::int64_t>(kGlobalShare * static_cast<double>(options_.evaluations)));
    }

    void refine(const PoseProblem& problem) {
        SceneEnergy energy(problem);
        energy.pose(trial_.dofs);
        double best = energy.energy();
        // Searches these degrees of freedom and keeps a better result; whether there was one.
        const auto improves = [&](const Dofs& which) {
            const std::int64_t left = options_.evaluations - trial_.evaluations;
            if (which.empty() || left <= 0 || trial_.reason != PoseSearch::StopReason::Evaluations) return false;
            std::vector<double> next = trial_.dofs;
            const double found = search(problem, energy, next, which, kRefinedSigma, 1,
                                        std::min<std::int64_t>(left, kRefinedGenerations * options_.population));
            const bool isBetter = trial_.reason == PoseSearch::StopReason::Evaluations && found < best;
            if (isBetter) best = found, trial_.dofs = std::move(next);
            trial_.history.push_back(best);
            energy.pose(trial_.dofs);
            energy.terms();
            return isBetter;
        };
        while (trial_.evaluations < options_.evaluations && goesOn(best)) {
            const std::vector<BitMask> artefacts = visibleArtefacts(energy);
            const bool areNone =
                std::all_of(artefacts.begin(), artefacts.end(), [](const BitMask& mask) { return mask.count() == 0; });
            if (best <= options_.residual && areNone) {
                trial_.reason = PoseSearch::StopReason::Satisfied;
                break;
            }
            bool isBetter = false;
            for (const Dofs& chain : occludedChains(problem, energy)) isBetter |= improves(chain);
            if (isBetter) continue;
            // Without artefacts, any degree of freedom may lower the rest of the energy.
            Dofs beside = dofsBeside(problem, energy, artefacts);
            if (beside.empty()) {
                beside.resize(trial_.dofs.size());
                std::iota(beside.begin(), beside.end(), std::size_t{0});
            }
            improves(beside);
        }
    }

    const PoseSearch::Options& options_;
    const PoseSearch::AskStop& askStop_;
    const PoseProblem fine_;
    Rng rng_;
    PoseSearch::Trial trial_;
};

}  // namespace

PoseSearch::Trial paperMethod(const PoseProblem& problem, std::uint64_t seed, const PoseSearch::Options& options,
                              const PoseSearch::AskStop& askStop) {
    return TrialRun(problem, seed, options, askStop).run();
}

}  // namespace fantascope::theatre
