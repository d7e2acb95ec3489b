#pragma once

#include "theatre/body/actor_pose.h"
#include "theatre/search/inverse_kinematics.h"
#include "theatre/stage/stage.h"

#include <vector>

namespace fantascope::theatre {

// Interpolates an actor's poses between the frames of a motion, so that it plays at any rate.
// Rotations follow a quaternion spline (squad: Shoemake 1987), the root a cubic spline (Catmull &
// Rom 1974). Both go through all frames with continuous velocity. A contact that is at one place in
// two adjacent frames stays there in between, by inverse kinematics.
// Thread: thread-bound.
class PoseSpline {
public:
    // `frames`: one or more. `loops`: after the last comes the first. `body` and `stage` must
    // outlive this object.
    PoseSpline(const Body& body, const Stage& stage, std::vector<ActorPose> frames, bool loops);

    // The degrees of freedom at a moment, in frames from the first, which may lie between two. A
    // loop takes any moment; otherwise the ends are held. The result is valid until the next call.
    // Only the first call allocates.
    const std::vector<double>& at(double frame);

private:
    std::size_t next(std::size_t frame) const;
    std::size_t before(std::size_t frame) const;

    const Body& body_;
    std::vector<ActorPose> frames_;                  // quaternions of adjacent frames are on one side of the double cover
    std::vector<std::vector<glm::dquat>> tangents_;  // squad's inner points: [frame][joint]
    std::vector<std::vector<HeldContact>> bearing_;  // of each frame
    bool loops_;
    InverseKinematics kinematics_;
    ActorPose pose_;
    std::vector<double> dofs_;
    std::vector<HeldContact> held_;
};

}  // namespace fantascope::theatre
