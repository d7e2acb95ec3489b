#pragma once

#include "theatre/search/pose_search.h"

namespace fantascope::theatre {

// Won & Lee 2016, section 4: CMA-ES over all actors' degrees of freedom at once, from T-poses in a
// row (Figure 6a). While the residual energy is above Options::residual or artefacts are seen (b),
// CMA-ES runs again with fewer degrees of freedom and the rest fixed (c): those of chains of parts
// that are completely occluded and free to move; without any, or if they do not help, those of the
// parts beside the artefacts. A better result is kept. The last resort, one more actor, is the
// caller's: it is another problem.
//
// Half-size pixels and capsules until all degrees of freedom have been searched, then pixels of 256
// rows, and the skins if the problem has them. A trial without its quality. Thread: reentrant.
PoseSearch::Trial paperMethod(const PoseProblem& problem, std::uint64_t seed, const PoseSearch::Options& options,
                              const PoseSearch::AskStop& askStop);

}  // namespace fantascope::theatre
