#pragma once

#include "theatre/body/actor_pose.h"
#include "theatre/body/posed_body.h"
#include "theatre/stage/stage.h"

#include <optional>
#include <span>
#include <vector>

namespace fantascope::theatre {

// A contact held through a motion: a body part that bears at the representative frame, with its
// joint's place and rotation there, in the stage's frame.
struct HeldContact {
    std::uint32_t joint = 0;
    glm::dvec3 place{0};
    glm::dquat turn{1, 0, 0, 0};
};

// The parts of a body that touch the floor or a platform, by their spheres. A sphere that nearly
// touches counts, since spheres only approximate the skin.
std::vector<HeldContact> bearingParts(const Body& body, const Stage& stage, const PosedBody& posed);

// What ties an actor's pose at one frame to those at others (Won & Lee 2016, section 5).
struct Continuity {
    std::vector<ActorPose> neighbours;   // at the adjacent frames, as far as they are known: M_n(t - 1)
    std::optional<ActorPose> principal;  // M_n(t_0), at the representative frame
    std::vector<HeldContact> contacts;
};

// Equation 9, Diff: w^v times the root's squared distance (metres), plus w^q times each joint's
// squared geodesic distance (radians). q and -q are the same rotation. The paper leaves the weights
// open. Here a metre of the root counts as much as seven joints that rotate by a radian.
constexpr double kRootWeight = 1, kTurnWeight = 0.15;
double poseDifference(const Body& body, std::span<const double> dofs, const ActorPose& other);

// The shortest rotation vector from one rotation to another: to = rotationOf(vector) * from.
inline glm::dvec3 turnBetween(const glm::dquat& from, const glm::dquat& to) { return vectorOf(to * glm::conjugate(from)); }

// The sums of equation 11: squared millimetres, and squared radians.
struct ContactDrift {
    double place = 0, turn = 0;
};
ContactDrift contactDrift(std::span<const HeldContact> contacts, const PosedBody& posed);

}  // namespace fantascope::theatre
