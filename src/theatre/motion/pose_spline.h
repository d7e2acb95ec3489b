#pragma once

#include "theatre/body/actor_pose.h"
#include "theatre/search/inverse_kinematics.h"
#include "theatre/stage/stage.h"

#include <vector>

namespace fantascope::theatre {

// An actor's poses between those of a motion's frames, for playing it at any rate. Every turn goes
// along a quaternion spline (squad: Shoemake 1987), the root along a cubic one (Catmull & Rom
// 1974): through all frames, without a jump in speed. What stands on the ground in two frames, at
// one place, stands there in between, by inverse kinematics.
// Thread: thread-bound.
class PoseSpline {
public:
    // `frames`: one or more. `loops`: after the last comes the first. `body` and `stage` must live
    // on.
    PoseSpline(const Body& body, const Stage& stage, std::vector<ActorPose> frames, bool loops);

    // The degrees of freedom at a moment, in frames from the first, which may lie between two; of a
    // loop any moment, else the ends are held. They are there until it is asked again. No
    // allocation after the first.
    const std::vector<double>& at(double frame);

private:
    std::size_t next(std::size_t frame) const;
    std::size_t before(std::size_t frame) const;

    const Body& body_;
    std::vector<ActorPose> frames_;                  // neighbours' quaternions on one side of the double cover
    std::vector<std::vector<glm::dquat>> tangents_;  // squad's inner points: of each frame, of each joint
    std::vector<std::vector<HeldContact>> bearing_;  // of each frame
    bool loops_;
    InverseKinematics kinematics_;
    ActorPose pose_;
    std::vector<double> dofs_;
    std::vector<HeldContact> held_;
};

}  // namespace fantascope::theatre
