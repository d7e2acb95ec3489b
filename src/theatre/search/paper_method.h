#pragma once

#include "theatre/search/pose_search.h"

namespace fantascope::theatre {

// Won & Lee 2016, section 4: CMA-ES over all actors' degrees of freedom at once, from T-poses in a
// row (Figure 6a). While the residual energy is above Options::residual or artefacts are seen (b),
// CMA-ES runs again with fewer degrees of freedom and the rest fixed (c): those of chains of parts
// that are completely occluded and free to move; without any, or if they do not help, those of the
// parts beside the artefacts. A result is kept if it is better. The last resort, one more actor, is
// up to the caller, since it is another problem.
//
// The search over all degrees of freedom uses half as many rows, and capsules. Refinement uses at
// most 256 rows, and the skins if the problem has them. The trial's quality is not measured.
// Thread: reentrant.
PoseSearch::Trial paperMethod(const PoseProblem& problem, std::uint64_t seed, const PoseSearch::Options& options,
                              const PoseSearch::AskStop& askStop);

}  // namespace fantascope::theatre
