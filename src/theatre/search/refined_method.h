#pragma once

#include "theatre/search/pose_search.h"

namespace fantascope::theatre {

// The refined method has three stages (docs/decisions/0014). The global stage is CMA-ES with weak
// physics and a block of the covariance matrix for each actor. Then the outline is fitted. Then
// follows iterated local search: a limb or an actor is searched anew, or changed at random; the
// result is fitted and accepted by the rule of simulated annealing. Meanwhile physics stiffens
// until it holds people up. All this uses coarse pixels and capsules, except the last part of the
// local search: it uses at most 256 rows, and the skins if the problem has them. The trial's
// quality is not measured. Thread: reentrant.
PoseSearch::Trial refinedMethod(const PoseProblem& problem, std::uint64_t seed, const PoseSearch::Options& options,
                                const PoseSearch::AskStop& askStop);

}  // namespace fantascope::theatre
