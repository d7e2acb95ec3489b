#pragma once

#include "theatre/scene_energy.h"

#include "core/random.h"

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace fantascope::theatre {

// CMA-ES over some of the freedoms of a scene while the others are held: of one limb, of one actor, or all of them. Each actor's are a block of
// the covariance matrix, unless it is to be full.
// Thread: thread-bound.
class FreedomSearch {
public:
    struct Settings {
        double sigma = 0.5;  // in Body::scaleOf()
        int population = 40, generations = 100;
        double converged = 0;         // ends when the energies of the last generations differ by no more; 0: never
        bool fullCovariance = false;  // between actors too
    };

    // `problem` must live on.
    explicit FreedomSearch(const PoseProblem& problem);

    // Searches from `freedoms` over those with a number in `which` (ascending, of all actors' freedoms) and leaves the best candidate of
    // the last generation there; gives its energy. Candidates are brought within the limits. `beforeGeneration` may change the
    // problem's weights; when it gives false the search ends.
    double run(SceneEnergy& energy, std::span<double> freedoms, std::span<const std::size_t> which, const Settings& settings,
               Rng& rng, const std::function<bool(int)>& beforeGeneration = {});

    std::int64_t evaluations() const { return evaluations_; }

private:
    const PoseProblem& problem_;
    std::vector<double> candidate_, values_;
    std::int64_t evaluations_ = 0;
};

}  // namespace fantascope::theatre
