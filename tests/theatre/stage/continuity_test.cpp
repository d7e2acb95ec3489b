#include "theatre/stage/continuity.h"

#include "theatre/a_scene.h"
#include "theatre/search/silhouette_fit.h"

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <string>

namespace fantascope::theatre {
namespace {

TEST(PoseDifference, is_equation_9) {
    const PoseProblem problem = aScene({1.7});
    const Body& body = problem.actors[0];
    const std::vector<double> here = aRow(problem, {0}, 2);
    std::vector<double> there = here;
    EXPECT_EQ(poseDifference(body, here, poseOf(body, here)), 0);
    there[0] += 0.3;
    EXPECT_NEAR(poseDifference(body, there, poseOf(body, here)), kRootWeight * 0.09, 1e-12);
    there = here;
    there[body.joints[body.joint("left elbow")].first] += 0.2;
    there[body.joints[body.joint("right knee")].first] += 0.4;
    EXPECT_NEAR(poseDifference(body, there, poseOf(body, here)), kTurnWeight * (0.04 + 0.16), 1e-12);
}

// q and -q are one turn, so there are two ways around, and the short one counts.
TEST(PoseDifference, takes_the_short_way_around) {
    const PoseProblem problem = aScene({1.7});
    const Body& body = problem.actors[0];
    const std::vector<double> here = aRow(problem, {0}, 2);
    ActorPose other = poseOf(body, here);
    other.turns[0] = rotationOf({0, 0.1, 0}) * other.turns[0];
    const double near = poseDifference(body, here, other);
    EXPECT_NEAR(near, kTurnWeight * 0.01, 1e-12);
    for (glm::dquat& turn : other.turns) turn = -turn;
    EXPECT_NEAR(poseDifference(body, here, other), near, 1e-12);
}

TEST(BearingParts, are_those_that_touch_the_ground) {
    const PoseProblem problem = aScene({1.7});
    const Body& body = problem.actors[0];
    std::vector<double> dofs = aRow(problem, {0}, 2);
    PosedBody posed;
    posed.pose(body, dofs);
    std::vector<std::string> names;
    for (const HeldContact& contact : bearingParts(body, problem.stage, posed)) names.push_back(body.joints[contact.joint].name);
    EXPECT_THAT(names, testing::UnorderedElementsAre("left ankle", "right ankle"));
    dofs[1] += 0.1;
    posed.pose(body, dofs);
    EXPECT_THAT(bearingParts(body, problem.stage, posed), testing::IsEmpty());
    Stage raised = problem.stage;
    raised.platforms = {{"box", {0, 0.05, 2}, {1, 0.1, 1}}};
    EXPECT_THAT(bearingParts(body, raised, posed), testing::SizeIs(2));
}

TEST(ContactDrift, is_in_square_millimetres_and_radians) {
    const PoseProblem problem = aScene({1.7});
    const Body& body = problem.actors[0];
    PosedBody posed;
    posed.pose(body, aRow(problem, {0}, 2));
    const std::uint32_t foot = body.joint("left ankle");
    HeldContact contact{foot, posed.place(foot) + glm::dvec3(0.003, 0, 0.004), rotationOf({0, 0, 0.2}) * posed.turn(foot)};
    const ContactDrift drift = contactDrift({&contact, 1}, posed);
    EXPECT_NEAR(drift.place, 25, 1e-9);
    EXPECT_NEAR(drift.turn, 0.04, 1e-12);
}

// The terms of a motion, as the energy charges them.
TEST(SceneEnergy, charges_what_moves_only_in_a_motion) {
    PoseProblem problem = aScene({1.7, 1.5});
    const std::vector<double> here = aRow(problem, {-0.6, 0.6}, 2);
    makeTarget(problem, here);
    SceneEnergy still(problem);
    still.pose(here);
    EXPECT_EQ(still.terms().motion(problem.weights), 0);
    std::vector<double> beside = here;
    beside[0] += 0.1;
    const Body& body = problem.actors[0];
    const ActorPose pose = poseOf(body, std::span(beside).first(body.dofs));
    problem.continuity.resize(2);
    problem.continuity[0].neighbours = {pose, pose};
    problem.continuity[0].principal = pose;
    SceneEnergy moving(problem);
    moving.pose(here);
    EXPECT_NEAR(moving.terms().smooth, 2 * 0.01, 1e-12);
    EXPECT_NEAR(moving.terms().regular, 0.01, 1e-12);
    EXPECT_NEAR(moving.energy() - still.energy(), 600 * 0.01 + 40 * 0.01, 1e-9);
}

// With a target that asks for nothing and a neighbour that weighs heavily, the fit finds the
// neighbour: its derivatives are those of the energy.
TEST(SilhouetteFit, is_drawn_to_the_frame_beside) {
    PoseProblem problem = aScene({1.7});
    const std::vector<double> here = aRow(problem, {0}, 2);
    makeTarget(problem, here);
    const Body& body = problem.actors[0];
    Rng rng(5);
    const std::vector<double> beside = nudged(problem, here, rng, 0.3);
    problem.weights = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
    problem.continuity.resize(1);
    problem.continuity[0].neighbours = {poseOf(body, beside)};
    SceneEnergy energy(problem);
    SilhouetteFit fit(problem);
    std::vector<double> found = here;
    const double before = 300 * poseDifference(body, here, poseOf(body, beside));
    EXPECT_LT(fit.run(energy, found, 20), 1e-4 * before);
}

TEST(SilhouetteFit, keeps_what_bears_where_it_is) {
    PoseProblem problem = aScene({1.7});
    std::vector<double> here = aRow(problem, {0}, 2);
    const Body& body = problem.actors[0];
    for (const char* knee : {"left knee", "right knee"}) here[body.joints[body.joint(knee)].first] += 0.5;
    std::vector<double> shifted = here;
    shifted[0] += 0.1;
    makeTarget(problem, shifted);
    PosedBody posed;
    posed.pose(body, here);
    problem.continuity.resize(1);
    for (const char* foot : {"left ankle", "right ankle"})
        problem.continuity[0].contacts.push_back({body.joint(foot), posed.place(body.joint(foot)), posed.turn(body.joint(foot))});
    SceneEnergy energy(problem);
    std::vector<double> found = here;
    SilhouetteFit(problem).run(energy, found, 30);
    posed.pose(body, found);
    for (const HeldContact& contact : problem.continuity[0].contacts)
        EXPECT_LT(glm::distance(posed.place(contact.joint), contact.place), 0.002);
    EXPECT_GT(found[0], here[0] + 0.02) << "the rest went towards the target";
}

}  // namespace
}  // namespace fantascope::theatre
