#include "theatre/stage/stage.h"

#include "theatre/a_stage.h"

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <cmath>

namespace fantascope::theatre {
namespace {

class OfAStage : public testing::Test {
protected:
    const Stage stage = aStage({0.5, 1, 7});
    // 2 cm a pixel; the picture's top left corner at (-1, 3).
    const ScreenFrame frame{stage, -1, 3, 0.02, 200, 150};
};

TEST_F(OfAStage, frames_turn_pixels_into_metres_of_the_screen_and_back) {
    EXPECT_LT(glm::distance(frame.pixelAt(-1, 3), glm::dvec2(0, 0)), 1e-9);
    EXPECT_LT(glm::distance(frame.pixelAt(0, 2.5), glm::dvec2(50, 25)), 1e-9);
    EXPECT_LT(glm::distance(frame.metresAt({50, 25}), glm::dvec2(0, 2.5)), 1e-12);
}

TEST_F(OfAStage, what_is_on_the_screen_is_its_own_shadow) {
    EXPECT_LT(glm::distance(frame.shadow({0.3, 1.7, 0}), frame.pixelAt(0.3, 1.7)), 1e-9);
}

// Halfway to the light everything is twice as far from the light's foot.
TEST_F(OfAStage, shadows_grow_towards_the_light) {
    EXPECT_LT(glm::distance(frame.shadow({0.7, 1.3, 3.5}), frame.pixelAt(0.9, 1.6)), 1e-9);
    EXPECT_LT(glm::distance(frame.shadow({0.5, 1, 3}), frame.pixelAt(0.5, 1)), 1e-9);
}

TEST_F(OfAStage, a_light_is_a_pinhole_camera) {
    const glm::dvec3 point(1.1, 0.2, 2), d = frame.fromLight(point);
    EXPECT_LT(glm::distance(d, glm::dvec3(0.6, 0.8, 5)), 1e-12);
    EXPECT_LT(glm::distance(frame.foot(), frame.pixelAt(0.5, 1)), 1e-9);
    EXPECT_DOUBLE_EQ(frame.focus(), 350);
    EXPECT_LT(glm::distance(frame.foot() + frame.focus() / d.z * glm::dvec2(d), frame.shadow(point)), 1e-9);
}

// 1 m wide, 40 cm high and 10 cm deep. Turned by 30 degrees its right end is nearer to the screen.
TEST(Platform, is_turned_right_handed_about_the_upright) {
    const Stage::Platform platform{"step", {1, 0.2, 2}, {1, 0.4, 0.1}, radians(30)};
    const double c = std::cos(radians(30)), s = std::sin(radians(30));
    EXPECT_TRUE(platform.isUnder(1 + 0.45 * c, 2 - 0.45 * s));
    EXPECT_TRUE(platform.isUnder(1 - 0.45 * c, 2 + 0.45 * s));
    EXPECT_FALSE(platform.isUnder(1 + 0.45 * c, 2 + 0.45 * s));
    EXPECT_FALSE(platform.isUnder(1 + 0.55 * c, 2 - 0.55 * s));
    EXPECT_DOUBLE_EQ(platform.top(), 0.4);
    // 20 cm beyond the right end, 5 cm before the long side, and 30 cm over the top.
    glm::dvec3 outward;
    EXPECT_NEAR(platform.distance({1 + 0.7 * c, 0.2, 2 - 0.7 * s}, outward), 0.2, 1e-12);
    EXPECT_LT(glm::distance(outward, {c, 0, -s}), 1e-12);
    EXPECT_NEAR(platform.distance({1 + 0.1 * s, 0.2, 2 + 0.1 * c}, outward), 0.05, 1e-12);
    EXPECT_LT(glm::distance(outward, {s, 0, c}), 1e-12);
    EXPECT_NEAR(platform.distance({1, 0.7, 2}, outward), 0.3, 1e-12);
    EXPECT_LT(glm::distance(outward, {0, 1, 0}), 1e-12);
}

TEST(Platform, distances_inside_are_to_the_nearest_side_and_outside_to_corners) {
    const Stage::Platform platform{"block", {0, 0.5, 0}, {1, 1, 1}, 0};
    glm::dvec3 outward;
    EXPECT_NEAR(platform.distance({-0.4, 0.5, 0.1}, outward), -0.1, 1e-12);
    EXPECT_LT(glm::distance(outward, {-1, 0, 0}), 1e-12);
    EXPECT_NEAR(platform.distance({0.1, 0.95, 0}, outward), -0.05, 1e-12);
    EXPECT_LT(glm::distance(outward, {0, 1, 0}), 1e-12);
    EXPECT_NEAR(platform.distance({0.1, 0.02, 0}, outward), -0.4, 1e-12) << "below is the floor";
    EXPECT_LT(glm::distance(outward, {1, 0, 0}), 1e-12);
    const Stage::Platform hangs{"roof", {0, 2.5, 0}, {1, 1, 1}, 0};
    EXPECT_NEAR(hangs.distance({0.1, 2.02, 0}, outward), -0.02, 1e-12);
    EXPECT_LT(glm::distance(outward, {0, -1, 0}), 1e-12);
    EXPECT_NEAR(platform.distance({0.8, 1.4, 0}, outward), 0.5, 1e-12);  // 3 - 4 - 5
    EXPECT_LT(glm::distance(outward, {0.6, 0.8, 0}), 1e-12);
}

TEST(Stage, ground_is_the_highest_top_that_is_not_above) {
    Stage stage;
    EXPECT_EQ(stage.groundUnder({0, 1, 0}), 0);
    stage.platforms = {
        {"step", {0, 0.1, 2}, {2, 0.2, 2}, 0}, {"block", {0, 0.25, 2}, {1, 0.5, 1}, 0}, {"roof", {0, 2, 2}, {4, 0.1, 4}, 0}};
    EXPECT_DOUBLE_EQ(stage.groundUnder({0, 1, 2}), 0.5);
    EXPECT_DOUBLE_EQ(stage.groundUnder({0.7, 1, 2}), 0.2);
    EXPECT_DOUBLE_EQ(stage.groundUnder({0, 0.4, 2}), 0.2) << "in the block the step is under it";
    EXPECT_DOUBLE_EQ(stage.groundUnder({1.5, 1, 2}), 0);
    EXPECT_DOUBLE_EQ(stage.groundUnder({1.5, 3, 2}), 2.05);
}

TEST(Stage, holders_must_be_among_the_actors) {
    Stage stage;
    EXPECT_TRUE(stage.checkHolders(0));
    stage.props.push_back({"hat", {}, nullptr, Prop::Holder{1, BodyPart::Head}, {}, {1, 0, 0, 0}});
    EXPECT_TRUE(stage.checkHolders(2));
    ASSERT_FALSE(stage.checkHolders(1));
    EXPECT_EQ(stage.checkHolders(1).error().message(),
              "prop 'hat' is held by actor 2, and there is one; let another hold it, or ask for more actors");
}

}  // namespace
}  // namespace fantascope::theatre
