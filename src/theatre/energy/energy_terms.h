#pragma once

#include "theatre/body/balance.h"
#include "theatre/body/posed_body.h"
#include "theatre/stage/stage.h"

#include <span>

namespace fantascope::theatre {

// The terms of an actor's own (Won & Lee 2016, equations 5 and 6), in the units of EnergyTerms.

// What a support polygon and a margin of balance are wanted to have; more is worth nothing.
constexpr double kAmpleArea = 0.1;     // square metres
constexpr double kAmpleMargin = 0.03;  // metres
// What a margin is to have at least: less counts kUnsure times more.
constexpr double kSureMargin = 0.011, kUnsure = 2;
// (6) Of Margin: what it lacks, centimetres.
double lackOfMargin(double margin);
// Half the angle of the cone that approximates what one sees: the field of both eyes.
constexpr double kSight = 1.0472;

// (5) The squared distance from the screen's middle to the nearest point of the cone of sight, square metres; all in the screen's
// frame. A cone that does not reach the screen costs kUnseen and more the farther it is turned
// away: infinity would leave a search without a direction.
constexpr double kUnseen = 1000;
double unseen(const glm::dvec3& eyes, const glm::dvec3& gaze, const glm::dvec3& screenMiddle);

// (6) PtDepth(B_n, B_n): the sum over capsules that must be apart of their squared depth in each other, square millimetres.
double depthInItself(const Body& body, const PosedBody& posed);
// (6) PtDepth(B_n, B_m).
double depthInOther(const PosedBody& a, const PosedBody& b);
// (6) PtDepth(B_n, E_k) of the floor and the screens, summed over the spheres.
double depthInStage(const Stage& stage, const PosedBody& posed);

// The deepest of the same, metres, for reports: how far the floor, a screen, one's own body or
// another's is in the way.
double deepestInItself(const Body& body, const PosedBody& posed);
double deepestInOther(const PosedBody& a, const PosedBody& b);
double deepestInStage(const Stage& stage, const PosedBody& posed);

// (4) How often the owner changes from one point of the contour to the next, around; what is nobody's, but a platform's or a
// prop's, is passed over.
constexpr int kNobody = -1;
int ownerChanges(std::span<const int> owners);

}  // namespace fantascope::theatre
