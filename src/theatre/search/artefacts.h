#pragma once

#include "theatre/energy/pose_problem.h"
#include "theatre/energy/scene_energy.h"

#include <vector>

namespace fantascope::theatre {

// What an audience sees to be wrong in a shadow, and who could mend it: Won & Lee 2016, section 4,
// "Optimization Algorithm", and Figure 6. Parts of bodies are told by their capsules' shadows.
// Thread: reentrant.

// Where shadow and target differ by so much that a disc of this diameter fits into it: holes, and
// mismatches of the outline. Pixels of a target 256 high.
constexpr double kVisibleArtefact = 8;
BitMask visibleArtefacts(const PoseTarget& target, const BitMask& shadow);
// Of each beam; `energy` is posed, its terms asked for.
std::vector<BitMask> visibleArtefacts(const SceneEnergy& energy);

// Dofs as numbers among those of all actors, ascending.
using Dofs = std::vector<std::size_t>;

// Of each end-effector (head, hands, feet) whose shadow lies, on every beam's screen, wholly in
// that of all else, props included: the degrees of freedom of its joint and of those above it, as
// far up as all that hangs below is occluded so. A part that is free to move hides no other: of two
// that only hide each other the first is free. `energy` is posed, its terms asked for.
std::vector<Dofs> occludedChains(const PoseProblem& problem, const SceneEnergy& energy);

// The degrees of freedom of the parts whose shadow is beside one of a beam's artefacts, or in it:
// of the part's joint and of the one that it hangs on, but for the root's unless the part is the
// pelvis itself.
Dofs dofsBeside(const PoseProblem& problem, const SceneEnergy& energy, std::span<const BitMask> artefacts);

}  // namespace fantascope::theatre
