#include "theatre/body/actor_pose.h"

namespace fantascope::theatre {

ActorPose poseOf(const Body& body, std::span<const double> dofs) {
    ActorPose pose{{dofs[0], dofs[1], dofs[2]}, {rotationOf({dofs[3], dofs[4], dofs[5]})}};
    for (std::size_t i = 1; i < body.joints.size(); ++i) {
        const JointMotion& motion = body.joints[i].motion;
        pose.turns.push_back(motion.orientation(dofs.subspan(body.joints[i].first, motion.size())));
    }
    return pose;
}

void dofsOf(const Body& body, const ActorPose& pose, std::vector<double>& dofs) {
    dofs.resize(body.dofs);
    const glm::dvec3 turn = vectorOf(pose.turns[0]);
    for (int i = 0; i < 3; ++i) dofs[static_cast<std::size_t>(i)] = pose.root[i], dofs[static_cast<std::size_t>(i) + 3] = turn[i];
    for (std::size_t i = 1; i < body.joints.size(); ++i) {
        const JointMotion& motion = body.joints[i].motion;
        motion.numbers(pose.turns[i], std::span(dofs).subspan(body.joints[i].first, motion.size()));
    }
}

std::vector<double> dofsOf(const Body& body, const ActorPose& pose) {
    std::vector<double> dofs;
    dofsOf(body, pose, dofs);
    return dofs;
}

}  // namespace fantascope::theatre
