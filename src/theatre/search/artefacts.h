#pragma once

#include "theatre/energy/pose_problem.h"
#include "theatre/energy/scene_energy.h"

#include <vector>

namespace fantascope::theatre {

// Visible artefacts of a shadow, and the degrees of freedom that could repair them: Won & Lee 2016,
// section 4, "Optimization Algorithm", and Figure 6. The shadow of a body part is that of its
// capsules.
// Thread: reentrant.

// Where shadow and target differ so widely that a disc of this diameter fits into the difference:
// holes, and mismatches of the outline. The diameter is in pixels of a target 256 high.
constexpr double kVisibleArtefact = 8;
BitMask visibleArtefacts(const PoseTarget& target, const BitMask& shadow);
// One mask a beam. `energy` must be posed and its terms() up to date.
std::vector<BitMask> visibleArtefacts(const SceneEnergy& energy);

// Degrees of freedom as indices among those of all actors, ascending.
using Dofs = std::vector<std::size_t>;

// The chains of completely occluded parts. A chain starts at an end-effector (head, hands, feet)
// whose shadow lies, on every beam's screen, entirely in the shadow of all else, props included. It
// goes up the joints as long as everything below is occluded in this way, and has the degrees of
// freedom of its joints. A part in a chain no longer hides others: if two parts hide only each
// other, the first is taken. `energy` must be posed and its terms() up to date.
std::vector<Dofs> occludedChains(const PoseProblem& problem, const SceneEnergy& energy);

// The degrees of freedom of the parts whose shadow meets or adjoins an artefact: those of the
// part's joint and its parent. The root's are included only if the part is the pelvis itself.
Dofs dofsBeside(const PoseProblem& problem, const SceneEnergy& energy, std::span<const BitMask> artefacts);

}  // namespace fantascope::theatre
