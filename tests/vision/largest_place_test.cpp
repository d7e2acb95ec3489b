#include "vision/largest_place.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <cmath>

namespace fantascope::vision {
namespace {

// A camera six metres from the wall z = 0, and what a rectangle of the wall looks like to it.
CameraModel camera() {
    return *CameraModel::fromFieldOfView(*Pose::lookingAt({1, 1.2, 6}, {0, 1, 0}), {320, 240}, 1.2, -0.04, 0);
}

ProjectorMap lit(glm::dvec2 low, glm::dvec2 high) {
    const CameraModel eye = camera();
    ProjectorMap map{Image<glm::vec2>(320, 240, glm::vec2(std::nanf(""))), {}, 0, 0};
    for (int y = 0; y < 240; ++y)
        for (int x = 0; x < 320; ++x) {
            const auto wall = Plane{}.hitBy(eye.rayThrough({x + 0.5, y + 0.5}));
            if (wall && wall->x > low.x && wall->x < high.x && wall->y > low.y && wall->y < high.y)
                map.at.at(x, y) = glm::vec2(1);
        }
    return map;
}

std::array<glm::dvec3, 4> onTheWall(const std::array<glm::dvec2, 4>& corners) {
    std::array<glm::dvec3, 4> wall;
    for (std::size_t i = 0; i < 4; ++i) wall[i] = *Plane{}.hitBy(camera().rayThrough(corners[i]));
    return wall;
}

// Three metres by one and a half are lit: a canvas of 16 : 9 is as high as they are, and level.
TEST(LargestPlace, fills_what_is_lit_and_stands_upright) {
    const ProjectorMap map = lit({-1.5, 0.2}, {1.5, 1.7});
    const auto place = largestPlace(camera(), {{CanvasPart(), &map}}, 16.0 / 9, uprightFromView(camera(), Plane{}));
    ASSERT_TRUE(place);
    const auto wall = onTheWall(*place);
    EXPECT_NEAR(wall[0].y, wall[1].y, 1e-6);
    EXPECT_NEAR(wall[0].x, wall[3].x, 1e-6);
    EXPECT_LT(wall[0].x, wall[1].x) << "not mirrored";
    EXPECT_GT(wall[0].y, wall[3].y) << "not upside down";
    EXPECT_NEAR((wall[1].x - wall[0].x) / (wall[0].y - wall[3].y), 16.0 / 9, 1e-6);
    EXPECT_GT(wall[0].y - wall[3].y, 1.3);
    EXPECT_GE(wall[3].y, 0.2);
    EXPECT_LE(wall[0].y, 1.7);
}

// The parts overlap as much as the light does at one size only; a smaller canvas leaves one of
// them.
TEST(LargestPlace, lets_each_part_lie_in_its_own_light) {
    const ProjectorMap left = lit({-2.1, 0.2}, {0.4, 1.9}), right = lit({-0.4, 0.2}, {2.1, 1.9});
    const std::vector<LitPart> parts{{{{0, 0}, {0.55, 1}}, &left}, {{{0.45, 0}, {1, 1}}, &right}};
    const auto place = largestPlace(camera(), parts, 2.6, uprightFromView(camera(), Plane{}));
    ASSERT_TRUE(place);
    const auto wall = onTheWall(*place);
    const double width = wall[1].x - wall[0].x;
    EXPECT_GE(wall[0].x, -2.1);
    EXPECT_LE(wall[0].x + 0.55 * width, 0.4);
    EXPECT_GE(wall[0].x + 0.45 * width, -0.4);
    EXPECT_LE(wall[1].x, 2.1);
    EXPECT_GT(width, 3.7);
}

TEST(LargestPlace, is_nowhere_if_the_parts_do_not_meet) {
    const ProjectorMap left = lit({-2.1, 0.2}, {-1.6, 1.9}), right = lit({1.6, 0.2}, {2.1, 1.9});
    const std::vector<LitPart> parts{{{{0, 0}, {0.55, 1}}, &left}, {{{0.45, 0}, {1, 1}}, &right}};
    EXPECT_FALSE(largestPlace(camera(), parts, 2.6, uprightFromView(camera(), Plane{})));
}

}  // namespace
}  // namespace fantascope::vision
