#pragma once

#include "theatre/energy/scene_energy.h"
#include "theatre/search/dof_search.h"
#include "theatre/search/silhouette_fit.h"

#include <array>
#include <cstdint>
#include <utility>

namespace fantascope::theatre {

// The rising stiffness of physics, for fits that are repeated while a pose is invalid.
constexpr std::array kMending = {2.0, 4.0, 8.0, 16.0};

// A problem with its energy, search and fit. Thread: bound to one thread at a time.
struct Workshop {
    explicit Workshop(PoseProblem given) : problem(std::move(given)), energy(problem), search(problem), fit(problem) {}
    Workshop(const Workshop&) = delete;
    Workshop& operator=(const Workshop&) = delete;

    std::int64_t evaluations() const { return search.evaluations() + fit.evaluations(); }
    double iou() const { return intersectionOverUnion(energy.shadow(), problem.targets[0].mask); }

    const PoseProblem problem;
    SceneEnergy energy;
    DofSearch search;
    SilhouetteFit fit;
};

}  // namespace fantascope::theatre
