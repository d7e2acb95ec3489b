#include "theatre/stage/stage_set.h"

#include "theatre/a_scene.h"

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

namespace fantascope::theatre {
namespace {

// A body that is one ball of 10 cm, or a bar of balls from its place to the right.
Body ballBody(double length = 0) {
    Body body;
    body.joints.resize(1);
    body.joints[0].mass = 1;
    body.spheres = {{0, {0, 0, 0}, 0.1}, {0, {length, 0, 0}, 0.1}};
    body.capsules = {{0, 0, 1}};
    return body;
}
PosedBody at(const Body& body, glm::dvec3 place) {
    PosedBody posed;
    posed.pose(body, std::vector<double>{place.x, place.y, place.z, 0, 0, 0});
    return posed;
}

// Against the exact distance to a box; a cell of the grid is 1.4 m / 64.
TEST(MeshDistance, is_that_of_a_box) {
    const glm::dvec3 size(1, 0.6, 0.4);
    const Prop box = aBox(size, {});
    const Stage::Platform exact{"box", {0, 10, 0}, size, 0};  // in the air
    Rng rng(4);
    glm::dvec3 outward, wanted;
    for (int i = 0; i < 2000; ++i) {
        const glm::dvec3 point(rng.uniform(-0.69, 0.69), rng.uniform(-0.49, 0.49), rng.uniform(-0.39, 0.39));
        const double distance = exact.distance(point + glm::dvec3(0, 10, 0), wanted);
        EXPECT_NEAR(box.shape->distance.at(point, outward), distance, 0.012) << i;
        EXPECT_NEAR(glm::length(outward), 1, 1e-9);
    }
    EXPECT_NEAR(box.shape->distance.at({0.1, 0.35, 0.1}, outward), 0.05, 1e-3);
    EXPECT_LT(glm::distance(outward, {0, 1, 0}), 1e-3);
    EXPECT_NEAR(box.shape->distance.at({0.45, 0, 0}, outward), -0.05, 1e-3);
    EXPECT_LT(glm::distance(outward, {1, 0, 0}), 1e-3);
    // Outside the grid: no more than the truth, and never near.
    EXPECT_NEAR(box.shape->distance.at({2.5, 0, 0}, outward), 2, 0.03);
    EXPECT_LE(box.shape->distance.at({2.5, 0, 0}, outward), 2 + 1e-6);
    EXPECT_LT(glm::distance(outward, {1, 0, 0}), 1e-9);
}

TEST(MeshDistance, knows_the_inside_of_a_box_with_a_hole) {
    TriangleMesh mesh = aBox({1, 1, 1}, {}).shape->mesh;
    mesh.triangles.pop_back();  // half of the right side
    const MeshDistance distance(mesh, 0.2);
    glm::dvec3 outward;
    EXPECT_LT(distance.at({0, 0, 0}, outward), -0.45);
    EXPECT_LT(distance.at({0.3, 0.2, -0.2}, outward), 0);
    EXPECT_GT(distance.at({0.65, 0.2, -0.2}, outward), 0);
    EXPECT_GT(distance.at({-0.65, 0.2, -0.2}, outward), 0);
}

TEST(OverFloor, lowers_what_is_over_a_platform) {
    Stage stage;
    const std::vector<PlacedSphere> spheres{{{0, 0.5, 2}, 0.1}, {{3, 0.5, 2}, 0.1}, {{0, 0.3, 2}, 0.1}};
    std::vector<PlacedSphere> scratch;
    Contacts contacts;
    EXPECT_EQ(overFloor(stage, spheres, scratch).data(), spheres.data()) << "a bare stage costs nothing";
    findContacts(spheres, contacts);
    EXPECT_NEAR(contacts.lowest, 0.2, 1e-12);
    stage.platforms = {{"block", {0, 0.2, 2}, {1, 0.4, 1}, 0}};
    const auto lowered = overFloor(stage, spheres, scratch);
    ASSERT_EQ(lowered.size(), 3u);
    EXPECT_NEAR(lowered[0].centre.y, 0.1, 1e-12);
    EXPECT_NEAR(lowered[1].centre.y, 0.5, 1e-12);
    EXPECT_NEAR(lowered[2].centre.y, 0.3, 1e-12) << "in the block nothing is over it";
    findContacts(lowered, contacts);
    EXPECT_NEAR(contacts.lowest, 0, 1e-12);
}

// By hand: a ball of 10 cm whose middle is 6 cm from a block's right side, 50 cm up.
TEST(Intrusions, of_a_ball_in_a_platform_and_in_a_prop) {
    const Body body = ballBody();
    const PosedBody posed = at(body, {0.56, 0.5, 2});
    const auto check = [&](const Stage& stage, double accuracy) {
        std::vector<PlacedProp> standing;
        placeStanding(stage, standing);
        std::vector<Intrusion> found;
        findIntrusions(stage, standing, body, posed, {}, found);
        ASSERT_EQ(found.size(), 1u);
        EXPECT_NEAR(found[0].depth, 0.04, accuracy);
        EXPECT_LT(glm::distance(found[0].outward, {1, 0, 0}), 10 * accuracy + 1e-12);
        EXPECT_EQ(found[0].joint, 0u);
        EXPECT_FALSE(found[0].otherJoint);
        EXPECT_NEAR(squaredDepths(found), 1600, 1e5 * accuracy + 1e-6);
        EXPECT_NEAR(deepest(found), 0.04, accuracy);
    };
    Stage stage;
    stage.platforms = {{"block", {0, 0.5, 2}, {1, 1, 1}, 0}, {"far", {5, 0.5, 2}, {1, 1, 1}, 0}};
    check(stage, 1e-12);
    stage.platforms.clear();
    stage.props = {aBox({1, 1, 1}, {0, 0.5, 2})};
    check(stage, 1e-3);
    // Turned by a quarter about the upright a long box is as deep as it was wide.
    stage.props = {aBox({3, 1, 1}, {0, 0.5, 2})};
    stage.props[0].turn = rotationOf({0, std::numbers::pi / 2, 0});
    check(stage, 1e-3);
}

// A bar whose ends are free: its middle rests in a wall of 10 cm.
TEST(Intrusions, are_felt_between_a_capsules_ends) {
    const Body body = ballBody(1);
    Stage stage;
    stage.platforms = {{"wall", {0.5, 0.5, 2}, {0.1, 1, 1}, 0}};
    std::vector<Intrusion> found;
    findIntrusions(stage, {}, body, at(body, {0, 1.08, 2}), {}, found);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NEAR(found[0].depth, 0.02, 1e-12);
    EXPECT_NEAR(found[0].point.x, 0.5, 0.05);
    findIntrusions(stage, {}, body, at(body, {0, 1.11, 2}), {}, found);
    EXPECT_TRUE(found.empty());
}

// A staff of 2 m held by its middle at 90 cm is 10 cm in the floor; the hand that holds it is not
// in it.
TEST(Intrusions, of_what_is_held_in_floor_screen_and_platform) {
    const Body body = humanBody(1.7);
    PosedBody posed;
    posed.pose(body, body.restPose({0, body.joints[0].offset.y, 3}, {1, 0, 0, 0}));
    const glm::dvec3 hand = posed.point(body.parts[static_cast<std::size_t>(BodyPart::LeftHand)]);
    Prop staff = aBox({0.02, 2, 0.02}, {0, 0.9 - hand.y, 0});
    staff.holder = Prop::Holder{2, BodyPart::LeftHand};
    Stage stage;
    stage.props = {staff};
    std::vector<PlacedProp> held;
    placeHeld(stage, 0, body, posed, held);
    EXPECT_TRUE(held.empty()) << "another's";
    placeHeld(stage, 2, body, posed, held);
    ASSERT_EQ(held.size(), 1u);
    EXPECT_LT(glm::distance(held[0].place, {hand.x, 0.9, hand.z}), 1e-9);
    std::vector<Intrusion> found;
    findIntrusions(stage, {}, body, posed, held, found);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NEAR(found[0].depth, 0.1, 1e-6);
    EXPECT_EQ(found[0].outward, glm::dvec3(0, 1, 0));
    EXPECT_EQ(found[0].joint, body.joint("left wrist"));
    // In a platform of 30 cm as well, and by a longer one across the body's own leg in it too.
    stage.platforms = {{"block", {hand.x, 0.15, hand.z}, {0.5, 0.3, 0.5}, 0}};
    findIntrusions(stage, {}, body, posed, held, found);
    EXPECT_EQ(found.size(), 2u);
    stage.platforms.clear();
    stage.props[0] = aBox({2, 0.1, 0.1}, {-hand.x, 0.5 - hand.y, 0});
    stage.props[0].holder = Prop::Holder{2, BodyPart::LeftHand};
    placeHeld(stage, 2, body, posed, held);
    findIntrusions(stage, {}, body, posed, held, found);
    ASSERT_FALSE(found.empty());
    for (const Intrusion& intrusion : found) EXPECT_EQ(intrusion.otherJoint, body.joint("left wrist"));
}

TEST(StandingArea, is_left_by_what_bears_farthest_outside) {
    Stage stage;
    const Contacts contacts{{{{0, 2}, 0.1}, {{1.3, 2.4}, 0.1}}, true};
    EXPECT_EQ(farthestOutside(stage, contacts), 0);
    stage.standing = Stage::Area{{-1, 0}, {1, 2}};
    EXPECT_NEAR(farthestOutside(stage, contacts), 0.5, 1e-12);
    stage.standing->to = {Stage::Area::kFar, 2};
    EXPECT_NEAR(farthestOutside(stage, contacts), 0.4, 1e-12);
}

}  // namespace
}  // namespace fantascope::theatre
