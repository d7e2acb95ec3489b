#include "core/geometry.h"

#include "core/random.h"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace fantascope {
namespace {

using testing::HasSubstr;

using Corners = std::array<glm::dvec2, 4>;

// A keystone: a projector that stands to the left and below.
const Corners kKeystone = {{{103.5, 41.25}, {1811, 12.5}, {1702.75, 1033}, {61, 987.125}}};

double greatestError(const Homography& map, const Corners& source, const Corners& target) {
    double greatest = 0;
    for (std::size_t i = 0; i < 4; ++i) greatest = std::max(greatest, glm::distance(map(source[i]), target[i]));
    return greatest;
}

std::string refusal(const Corners& corners) {
    const auto map = Homography::fromCorners(rectangleCorners(1, 1), corners);
    return map ? "accepted" : map.error().message();
}

TEST(Homography, carries_each_corner_to_its_target) {
    const Corners canvas = rectangleCorners(16.0 / 9, 1);
    EXPECT_LT(greatestError(*Homography::fromCorners(canvas, kKeystone), canvas, kKeystone), 1e-9);
    EXPECT_LT(greatestError(*Homography::fromCorners(kKeystone, canvas), kKeystone, canvas), 1e-12);
    EXPECT_LT(greatestError(*Homography::fromCorners(canvas, rectangleCorners(1920, 1080)), canvas, rectangleCorners(1920, 1080)),
              1e-9);
}

TEST(Homography, keeps_lines_straight_and_crosses_diagonals_where_they_cross) {
    const auto projectorFromCanvas = *Homography::fromCorners(rectangleCorners(2, 1), kKeystone);
    // Where the target's diagonals meet, by hand: the centre of a rectangle in perspective.
    const glm::dvec2 a = kKeystone[2] - kKeystone[0], b = kKeystone[3] - kKeystone[1], c = kKeystone[1] - kKeystone[0];
    const double along = (c.x * b.y - c.y * b.x) / (a.x * b.y - a.y * b.x);
    EXPECT_LT(glm::distance(projectorFromCanvas({1, 0.5}), kKeystone[0] + along * a), 1e-9);
}

TEST(Homography, inverse_and_product_are_those_of_the_maps) {
    const auto projectorFromCanvas = *Homography::fromCorners(rectangleCorners(2, 1), kKeystone);
    const auto wallFromProjector = *Homography::fromCorners(kKeystone, {{{-3, 4}, {3, 4.5}, {3, 0}, {-3, 0.5}}});
    for (const glm::dvec2 point : {glm::dvec2{0, 0}, {2, 1}, {0.3, 0.9}, {1.7, 0.2}}) {
        EXPECT_LT(glm::distance(projectorFromCanvas.inverse()(projectorFromCanvas(point)), point), 1e-12);
        EXPECT_LT(glm::distance((wallFromProjector * projectorFromCanvas)(point), wallFromProjector(projectorFromCanvas(point))),
                  1e-12);
    }
    EXPECT_EQ(Homography()({3, 4}), glm::dvec2(3, 4));
}

// (x, y) -> (1 / x, y / x) sends the origin to infinity; its four corners are as valid as any.
TEST(Homography, the_sources_origin_may_lie_on_the_horizon) {
    const Corners source = {{{1, 0}, {2, 0}, {2, 1}, {1, 1}}}, target = {{{1, 0}, {0.5, 0}, {0.5, 0.5}, {1, 1}}};
    const auto map = *Homography::fromCorners(source, target);
    EXPECT_LT(greatestError(map, source, target), 1e-12);
    EXPECT_LT(glm::distance(map({4, 2}), {0.25, 0.5}), 1e-12);
}

TEST(Homography, holds_for_any_convex_corners_anywhere) {
    Rng rng(1);
    for (int round = 0; round < 200; ++round) {
        const auto corners = [&] {  // a square of side 2 at another place and size, its corners moved by less than folds it
            const double size = std::exp(rng.uniform(-6, 6));
            const glm::dvec2 place(rng.uniform(-10, 10), rng.uniform(-10, 10));
            Corners moved = {{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
            for (glm::dvec2& corner : moved)
                corner = size * (place + corner + glm::dvec2(rng.uniform(-0.4, 0.4), rng.uniform(-0.4, 0.4)));
            return moved;
        };
        const Corners source = corners(), target = corners();
        const auto map = Homography::fromCorners(source, target);
        ASSERT_TRUE(map) << map.error().message();
        EXPECT_LT(greatestError(*map, source, target), 1e-9 * glm::distance(target[0], target[2]));
    }
}

// Rear projection and a mirror in the beam reverse the order of the corners.
TEST(Homography, mirrored_corners_are_fine) {
    const Corners mirrored = {{{1, 0}, {0, 0}, {0, 1}, {1, 1}}};
    EXPECT_LT(greatestError(*Homography::fromCorners(rectangleCorners(1, 1), mirrored), rectangleCorners(1, 1), mirrored), 1e-12);
}

TEST(Homography, corners_that_are_no_picture_are_refused_with_the_reason) {
    EXPECT_THAT(refusal({{{0, 0}, {1, 1}, {1, 0}, {0, 1}}}), HasSubstr("crossed or folded"));
    EXPECT_THAT(refusal({{{0, 0}, {1, 0}, {0.2, 0.2}, {0, 1}}}), HasSubstr("crossed or folded"));
    EXPECT_EQ(refusal({{{0, 0}, {1, 0}, {2, 0}, {0, 1}}}), "corners 1, 2 and 3 lie in a line");
    EXPECT_EQ(refusal({{{0, 0}, {0, 0}, {1, 1}, {0, 1}}}), "corners 1, 2 and 3 lie in a line");
    EXPECT_EQ(refusal({{{5, 5}, {5, 5}, {5, 5}, {5, 5}}}), "all corners are one point");
    EXPECT_EQ(refusal({{{0, 0}, {1, 0}, {1, std::numeric_limits<double>::quiet_NaN()}, {0, 1}}}),
              "a coordinate is not a finite number");
    EXPECT_FALSE(Homography::fromCorners({{{0, 0}, {1, 1}, {1, 0}, {0, 1}}}, rectangleCorners(1, 1)))
        << "the source is looked at too";
}

TEST(Rotation, turns_about_x_then_y_then_z_by_the_right_hand) {
    const auto near = [](glm::dvec3 a, glm::dvec3 b) { return glm::distance(a, b) < 1e-12; };
    const double quarter = std::numbers::pi / 2;
    EXPECT_TRUE(near(rotationXyz({quarter, 0, 0}) * glm::dvec3(0, 1, 0), {0, 0, 1}));
    EXPECT_TRUE(near(rotationXyz({0, quarter, 0}) * glm::dvec3(0, 0, 1), {1, 0, 0}));
    EXPECT_TRUE(near(rotationXyz({0, 0, quarter}) * glm::dvec3(1, 0, 0), {0, 1, 0}));
    EXPECT_TRUE(near(rotationXyz({quarter, 0, quarter}) * glm::dvec3(0, 1, 0), {0, 0, 1})) << "x first: then z leaves it alone";
    const glm::dvec3 angles(0.3, -1.1, 2.5);
    const glm::dmat3 steps = rotationXyz({0, 0, angles.z}) * rotationXyz({0, angles.y, 0}) * rotationXyz({angles.x, 0, 0});
    for (int column = 0; column < 3; ++column) EXPECT_TRUE(near(rotationXyz(angles)[column], steps[column]));
}

// Camera axes: x right, y down, z forward.
TEST(Pose, looks_along_z_with_x_to_the_right_and_y_down) {
    const Pose pose = *Pose::lookingAt({0, 2, 10}, {0, 2, 0});  // at the wall, from the front
    EXPECT_LT(glm::distance(pose.localFromWorld({0, 2, 0}), {0, 0, 10}), 1e-12) << "ahead";
    EXPECT_LT(glm::distance(pose.localFromWorld({1, 2, 10}), {1, 0, 0}), 1e-12) << "to the right";
    EXPECT_LT(glm::distance(pose.localFromWorld({0, 3, 10}), {0, -1, 0}), 1e-12) << "above";
    const Pose tilted = *Pose::lookingAt({3, 1, 5}, {-1, 4, -2});
    EXPECT_NEAR(glm::determinant(tilted.worldFromLocal), 1, 1e-12);
    EXPECT_NEAR(tilted.worldFromLocal[0].y, 0, 1e-12) << "the horizon is level";
    EXPECT_LT(glm::distance(tilted.localFromWorld({-1, 4, -2}), {0, 0, std::sqrt(16.0 + 9 + 49)}), 1e-12);
}

TEST(Pose, a_view_without_a_direction_or_a_top_is_refused) {
    EXPECT_THAT(Pose::lookingAt({1, 2, 3}, {1, 2, 3}).error().message(), HasSubstr("target and position are the same point"));
    EXPECT_THAT(Pose::lookingAt({0, 5, 0}, {0, 0, 0}).error().message(), HasSubstr("'up' is zero"));
    EXPECT_THAT(Pose::lookingAt({0, 5, 0}, {0, 0, 1}, {0, 0, 0}).error().message(), HasSubstr("'up' is zero"));
}

}  // namespace
}  // namespace fantascope
