#pragma once

#include "theatre/search/pose_search.h"

namespace fantascope::theatre {

// The global stage, CMA-ES with a block of the covariance for each actor, plays with weak physics;
// then the outline is fitted; then iterated local search: a limb, an actor or a random change is
// searched anew, fitted, and kept by the rule of simulated annealing, while physics stiffens until
// it holds people up (docs/decisions/0014). All that is in coarse pixels and with capsules; the
// last part of the local search has pixels of 256 rows, and the skins if the problem has them. A
// trial without its quality. Thread: reentrant.
PoseSearch::Trial refinedMethod(const PoseProblem& problem, std::uint64_t seed, const PoseSearch::Options& options,
                                const PoseSearch::AskStop& askStop);

}  // namespace fantascope::theatre
