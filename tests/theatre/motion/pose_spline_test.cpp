#include "theatre/motion/pose_spline.h"

#include "theatre/a_scene.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace fantascope::theatre {
namespace {

// Somebody who crouches, sways and turns, his feet where they are.
struct Swaying {
    PoseProblem problem = aScene({1.7});
    const Body& body = problem.actors[0];
    std::vector<ActorPose> frames;
    std::vector<HeldContact> feet;

    Swaying() {
        std::vector<double> standing = aRow(problem, {0}, 2);
        for (const char* knee : {"left knee", "right knee"}) standing[body.joints[body.joint(knee)].first] += 0.7;
        InverseKinematics kinematics(body);
        PosedBody posed;
        posed.pose(body, aRow(problem, {0}, 2));
        feet = bearingParts(body, problem.stage, posed);
        const double sway[] = {0, 0.12, -0.06, -0.14, 0.03}, crouch[] = {0.1, 0.2, 0.12, 0.28, 0.16};
        for (std::size_t i = 0; i < 5; ++i) {
            std::vector<double> pose = standing;
            pose[0] += sway[i], pose[1] -= crouch[i];
            pose[body.joints[body.joint("left shoulder")].first] += 2 * sway[i];
            pose[body.joints[body.joint("thorax")].first + 1] += 3 * sway[i];
            body.limit(pose);
            posed.pose(body, pose);
            std::vector<glm::dvec3> places;
            for (std::size_t k = 0; k < body.joints.size(); ++k) places.push_back(posed.place(k));
            kinematics.reach(pose, places, feet, 50);
            frames.push_back(poseOf(body, pose));
        }
    }
    double footDrift(std::span<const double> dofs) const {
        PosedBody posed;
        posed.pose(body, dofs);
        double most = 0;
        for (const HeldContact& foot : feet) most = std::max(most, glm::distance(posed.place(foot.joint), foot.place));
        return most;
    }
};

TEST(PoseSpline, goes_through_its_frames) {
    Swaying swaying;
    for (const bool loops : {false, true}) {
        PoseSpline spline(swaying.body, swaying.problem.stage, swaying.frames, loops);
        for (std::size_t i = 0; i < 5; ++i)
            EXPECT_LT(poseDifference(swaying.body, spline.at(static_cast<double>(i)), swaying.frames[i]), 1e-12) << i;
    }
}

TEST(PoseSpline, loops_or_holds_its_ends) {
    Swaying swaying;
    PoseSpline loop(swaying.body, swaying.problem.stage, swaying.frames, true);
    EXPECT_LT(poseDifference(swaying.body, loop.at(5.0), swaying.frames[0]), 1e-12);
    EXPECT_LT(poseDifference(swaying.body, loop.at(-2.0), swaying.frames[3]), 1e-12);
    PoseSpline once(swaying.body, swaying.problem.stage, swaying.frames, false);
    EXPECT_LT(poseDifference(swaying.body, once.at(9.3), swaying.frames[4]), 1e-12);
    EXPECT_LT(poseDifference(swaying.body, once.at(-1), swaying.frames[0]), 1e-12);
    PoseSpline still(swaying.body, swaying.problem.stage, {swaying.frames[2]}, true);
    EXPECT_LT(poseDifference(swaying.body, still.at(0.5), swaying.frames[2]), 1e-12);
}

// As fast into a frame as out of it; straight lines between frames would not be.
TEST(PoseSpline, has_no_corners_in_its_speed) {
    Swaying swaying;
    // The upper body alone, which nothing holds.
    for (ActorPose& frame : swaying.frames) frame.root.y += 1;
    PoseSpline spline(swaying.body, swaying.problem.stage, swaying.frames, true);
    const std::size_t shoulder = swaying.body.joints[swaying.body.joint("left shoulder")].first;
    constexpr double kStep = 1e-4;
    for (int frame = 0; frame < 5; ++frame)
        for (const std::size_t dof : {std::size_t{0}, shoulder}) {
            const double here = spline.at(frame)[dof];
            const double in = (here - spline.at(frame - kStep)[dof]) / kStep;
            const double out = (spline.at(frame + kStep)[dof] - here) / kStep;
            EXPECT_NEAR(in, out, 2e-3) << frame << ", " << dof;
        }
}

TEST(PoseSpline, keeps_feet_where_they_stand) {
    Swaying swaying;
    PoseSpline spline(swaying.body, swaying.problem.stage, swaying.frames, true);
    std::vector<ActorPose> lifted = swaying.frames;
    for (ActorPose& frame : lifted) frame.root.y += 1;
    PoseSpline free(swaying.body, swaying.problem.stage, lifted, true);
    double held = 0, drifted = 0;
    for (double frame = 0; frame < 5; frame += 0.125) {
        held = std::max(held, swaying.footDrift(spline.at(frame)));
        std::vector<double> lowered = free.at(frame);
        lowered[1] -= 1;
        drifted = std::max(drifted, swaying.footDrift(lowered));
    }
    EXPECT_LT(held, 0.002);
    EXPECT_GT(drifted, 0.004) << "by themselves they slide";
}

TEST(PoseSpline, takes_the_short_way_around) {
    Swaying swaying;
    std::vector<ActorPose> flipped = swaying.frames;
    for (glm::dquat& turn : flipped[1].turns) turn = -turn;
    for (glm::dquat& turn : flipped[4].turns) turn = -turn;
    PoseSpline spline(swaying.body, swaying.problem.stage, swaying.frames, true),
        other(swaying.body, swaying.problem.stage, flipped, true);
    for (double frame = 0.1; frame < 5; frame += 0.4)
        EXPECT_LT(poseDifference(swaying.body, other.at(frame), poseOf(swaying.body, spline.at(frame))), 1e-9) << frame;
}

}  // namespace
}  // namespace fantascope::theatre
