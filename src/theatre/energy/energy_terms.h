#pragma once

#include "theatre/body/balance.h"
#include "theatre/body/posed_body.h"
#include "theatre/stage/stage.h"

#include <span>

namespace fantascope::theatre {

// The terms of a single actor (Won & Lee 2016, equations 5 and 6), in the units of EnergyTerms.

// The wanted area of a support polygon and the wanted margin of balance. More brings no benefit.
constexpr double kAmpleArea = 0.1;     // square metres
constexpr double kAmpleMargin = 0.03;  // metres
// The least margin of balance, metres. A shortfall below it counts kUnsure times as much.
constexpr double kSureMargin = 0.011, kUnsure = 2;
// Equation 6, Margin: the shortfall of a margin, centimetres, with the weighting above. `margin` is
// in metres.
double lackOfMargin(double margin);
// Half the opening angle of the cone of sight, radians: the binocular field of view.
constexpr double kSight = 1.0472;

// Equation 5: the squared distance from the screen's middle to the nearest point of the cone of
// sight, square metres; all in the screen's frame. A cone that does not reach the screen costs
// kUnseen, and more the farther it is turned away. The paper's infinity would give a search no
// gradient.
constexpr double kUnseen = 1000;
double unseen(const glm::dvec3& eyes, const glm::dvec3& gaze, const glm::dvec3& screenMiddle);

// Equation 6, PtDepth(B_n, B_n): the sum over capsules that must be apart of their squared depth in
// each other, square millimetres.
double depthInItself(const Body& body, const PosedBody& posed);
// Equation 6, PtDepth(B_n, B_m).
double depthInOther(const PosedBody& a, const PosedBody& b);
// Equation 6, PtDepth(B_n, E_k) of the floor and the screens, summed over the spheres.
double depthInStage(const Stage& stage, const PosedBody& posed);

// The greatest depth of the same kinds, metres, for reports. 0 if nothing penetrates.
double deepestInItself(const Body& body, const PosedBody& posed);
double deepestInOther(const PosedBody& a, const PosedBody& b);
double deepestInStage(const Stage& stage, const PosedBody& posed);

// Equation 4: the number of changes of owner around the closed contour. Points that belong to
// nobody, but to a platform or a prop, are skipped.
constexpr int kNobody = -1;
int ownerChanges(std::span<const int> owners);

}  // namespace fantascope::theatre
