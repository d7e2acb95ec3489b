#pragma once

#include "theatre/body/body.h"

#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>

#include <span>
#include <vector>

namespace fantascope::theatre {

// M_n = (v_0, q_0, q_1 .. q_M) of Won & Lee 2016, section 3: the root's position (metres) and
// rotation in the stage's frame, and the rotation of each further joint relative to its parent, in
// the body's order.
struct ActorPose {
    glm::dvec3 root{0};
    std::vector<glm::dquat> turns;  // of all joints, the root's first
};
ActorPose poseOf(const Body& body, std::span<const double> dofs);
// The degrees of freedom nearest to a pose, within the joints' limits.
std::vector<double> dofsOf(const Body& body, const ActorPose& pose);
void dofsOf(const Body& body, const ActorPose& pose, std::vector<double>& dofs);

}  // namespace fantascope::theatre
