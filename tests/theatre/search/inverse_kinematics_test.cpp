#include "theatre/search/inverse_kinematics.h"

#include "theatre/a_scene.h"

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <vector>

namespace fantascope::theatre {
namespace {

struct Somebody {
    PoseProblem problem = aScene({1.7});
    const Body& body = problem.actors[0];
    std::vector<double> standing = aRow(problem, {0.2}, 2);
    InverseKinematics kinematics{body};
    PosedBody posed;

    std::vector<glm::dvec3> placesIn(const std::vector<double>& dofs) {
        posed.pose(body, dofs);
        std::vector<glm::dvec3> places;
        for (std::size_t i = 0; i < body.joints.size(); ++i) places.push_back(posed.place(i));
        return places;
    }
    std::vector<HeldContact> feetIn(const std::vector<double>& dofs) {
        posed.pose(body, dofs);
        std::vector<HeldContact> feet;
        for (const char* foot : {"left ankle", "right ankle"})
            feet.push_back({body.joint(foot), posed.place(body.joint(foot)), posed.turn(body.joint(foot))});
        return feet;
    }
};

TEST(InverseKinematics, finds_a_pose_of_joints_that_a_body_has) {
    Somebody somebody;
    Rng rng(3);
    for (int trial = 0; trial < 5; ++trial) {
        const std::vector<double> wanted = nudged(somebody.problem, somebody.standing, rng, 0.5);
        const std::vector<glm::dvec3> places = somebody.placesIn(wanted);
        std::vector<double> dofs = somebody.standing;
        const double left = somebody.kinematics.reach(dofs, places, {}, 100);
        EXPECT_LT(left, 0.003);
        // What it says is so, and within the limits.
        const std::vector<glm::dvec3> got = somebody.placesIn(dofs);
        double sum = 0;
        for (std::size_t i = 0; i < got.size(); ++i) sum += glm::dot(got[i] - places[i], got[i] - places[i]);
        EXPECT_NEAR(left, std::sqrt(sum / double(got.size())), 1e-12);
        std::vector<double> limited = dofs;
        somebody.body.limit(limited);
        EXPECT_THAT(limited, testing::Pointwise(testing::DoubleNear(1e-9), dofs));
    }
}

// Joints half as far apart again are out of reach: it comes as near as it can, and no farther away.
TEST(InverseKinematics, comes_near_to_what_is_out_of_reach) {
    Somebody somebody;
    std::vector<glm::dvec3> places = somebody.placesIn(somebody.standing);
    for (glm::dvec3& place : places) place = places[0] + 1.5 * (place - places[0]);
    std::vector<double> dofs = somebody.standing;
    const double before = somebody.kinematics.reach(dofs, places, {}, 0);
    EXPECT_LE(somebody.kinematics.reach(dofs, places, {}, 30), before);
}

TEST(InverseKinematics, holds_the_feet_while_the_rest_goes) {
    Somebody somebody;
    std::vector<double> crouching = somebody.standing;
    for (const char* side : {"left ", "right "}) {
        const auto& joints = somebody.body.joints;
        crouching[joints[somebody.body.joint(std::string(side) + "knee")].first] += 0.6;
    }
    const std::vector<HeldContact> feet = somebody.feetIn(crouching);
    std::vector<glm::dvec3> places = somebody.placesIn(crouching);
    for (glm::dvec3& place : places) place += glm::dvec3(0.15, 0, 0);  // as a whole, the feet too
    std::vector<double> dofs = crouching;
    somebody.kinematics.reach(dofs, places, feet, 40);
    const std::vector<glm::dvec3> got = somebody.placesIn(dofs);
    for (const HeldContact& foot : feet) {
        EXPECT_LT(glm::distance(got[foot.joint], foot.place), 0.005);
        EXPECT_LT(glm::length(turnBetween(foot.turn, somebody.posed.turn(foot.joint))), 0.1);
    }
    EXPECT_GT(got[somebody.body.head].x, somebody.placesIn(crouching)[somebody.body.head].x + 0.08);
}

TEST(InverseKinematics, puts_back_what_has_slipped_by_as_little_as_it_takes) {
    Somebody somebody;
    std::vector<double> crouching = somebody.standing;
    for (const char* side : {"left knee", "right knee"}) crouching[somebody.body.joints[somebody.body.joint(side)].first] += 0.5;
    const std::vector<HeldContact> feet = somebody.feetIn(crouching);
    std::vector<double> dofs = crouching;
    dofs[0] += 0.03, dofs[1] -= 0.02, dofs[4] += 0.05;
    EXPECT_TRUE(somebody.kinematics.hold(dofs, feet));
    const std::vector<glm::dvec3> got = somebody.placesIn(dofs);
    for (const HeldContact& foot : feet) EXPECT_LT(glm::distance(got[foot.joint], foot.place), 0.0011);
    // What does not bear has no reason to move.
    const std::size_t elbow = somebody.body.joints[somebody.body.joint("left elbow")].first;
    EXPECT_NEAR(dofs[elbow], crouching[elbow], 1e-6);

    std::vector<double> away = crouching;
    away[1] += 3;
    std::vector<HeldContact> apart = feet;
    apart[0].place += glm::dvec3(3, 0, 0);
    EXPECT_FALSE(somebody.kinematics.hold(away, apart)) << "no legs are so long";
}

}  // namespace
}  // namespace fantascope::theatre
