#include "theatre/body/actor_pose.h"

namespace fantascope::theatre {

ActorPose poseOf(const Body& body, std::span<const double> freedoms) {
    ActorPose pose{{freedoms[0], freedoms[1], freedoms[2]}, {rotationOf({freedoms[3], freedoms[4], freedoms[5]})}};
    for (std::size_t i = 1; i < body.joints.size(); ++i) {
        const JointMotion& motion = body.joints[i].motion;
        pose.turns.push_back(motion.orientation(freedoms.subspan(body.joints[i].first, motion.size())));
    }
    return pose;
}

void freedomsOf(const Body& body, const ActorPose& pose, std::vector<double>& freedoms) {
    freedoms.resize(body.freedoms);
    const glm::dvec3 turn = vectorOf(pose.turns[0]);
    for (int i = 0; i < 3; ++i)
        freedoms[static_cast<std::size_t>(i)] = pose.root[i], freedoms[static_cast<std::size_t>(i) + 3] = turn[i];
    for (std::size_t i = 1; i < body.joints.size(); ++i) {
        const JointMotion& motion = body.joints[i].motion;
        motion.numbers(pose.turns[i], std::span(freedoms).subspan(body.joints[i].first, motion.size()));
    }
}

std::vector<double> freedomsOf(const Body& body, const ActorPose& pose) {
    std::vector<double> freedoms;
    freedomsOf(body, pose, freedoms);
    return freedoms;
}

}  // namespace fantascope::theatre
