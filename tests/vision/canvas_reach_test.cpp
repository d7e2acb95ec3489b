#include "vision/canvas_reach.h"

#include <gmock/gmock.h>

#include <array>
#include <cmath>

namespace fantascope::vision {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using Corners = std::array<glm::dvec2, 4>;

CameraModel reachCamera() { return *CameraModel::fromFieldOfView(Pose{}, {320, 240}, 1.2, -0.1, 0); }

// All camera pixels between two columns are lit, but for a hole.
ProjectorMap columns(int from, int to, int holeSide) {
    ProjectorMap map{Image<glm::vec2>(320, 240, glm::vec2(std::nanf(""))), {}, 0, 0};
    for (int y = 20; y < 220; ++y)
        for (int x = from; x < to; ++x) map.at.at(x, y) = glm::vec2(1);
    for (int y = 100; y < 100 + holeSide; ++y)
        for (int x = 100; x < 100 + holeSide; ++x) map.at.at(x, y) = glm::vec2(std::nanf(""));
    return map;
}

TEST(PlacedCanvas, has_its_corners_where_they_are_and_straight_edges_without_the_distortion) {
    const Corners corners{{{20, 30}, {300, 20}, {310, 210}, {10, 220}}};
    const auto canvas = PlacedCanvas::of(reachCamera(), corners);
    ASSERT_TRUE(canvas);
    for (std::size_t i = 0; i < 4; ++i)
        EXPECT_LT(glm::distance(*canvas->pixelFromCanvas(rectangleCorners(1, 1)[i]), corners[i]), 1e-6) << i;
    EXPECT_LT(canvas->pixelFromCanvas({0.5, 0})->y, 22) << "a barrel bends the upper edge upwards";
    EXPECT_FALSE(PlacedCanvas::of(reachCamera(), {{{0, 0}, {9, 0}, {0, 9}, {9, 9}}})) << "crossed";
}

// A hole of a fallen leaf's size does not count, a tree's does; the light's rim is no light.
TEST(CanvasReach, is_what_an_output_lights_without_small_holes_and_rim) {
    const ProjectorMap leaf = columns(40, 200, 2), tree = columns(40, 200, 20);
    const CanvasReach reach(reachCamera(), {{{}, &leaf}, {{}, &tree}});
    ASSERT_EQ(reach.size(), 2u);
    EXPECT_TRUE(reach.isLit(0, {101, 101}));
    EXPECT_FALSE(reach.isLit(1, {110, 110}));
    EXPECT_TRUE(reach.isLit(0, {60, 60}));
    EXPECT_FALSE(reach.isLit(0, {41, 60})) << "the rim";
    EXPECT_FALSE(reach.isLit(0, {30, 60}));
    EXPECT_FALSE(reach.isLit(0, {-3, 60}));
    for (const glm::dvec2 pixel : reach.litPixels(1)) EXPECT_TRUE(reach.isLit(1, pixel));
    EXPECT_LT(reach.litPixels(1).size(), reach.litPixels(0).size());
}

// Each output has to light its own part, and what it encloses may have holes.
TEST(CanvasReach, names_the_parts_that_their_outputs_do_not_cover) {
    const ProjectorMap left = columns(20, 200, 20), right = columns(120, 300, 0);
    const CanvasReach reach(reachCamera(), {{{{0, 0}, {0.55, 1}}, &left}, {{{0.45, 0}, {1, 1}}, &right}});
    const auto uncovered = [&](const Corners& corners) { return reach.uncovered(*PlacedCanvas::of(reachCamera(), corners)); };
    EXPECT_THAT(uncovered({{{30, 40}, {290, 40}, {290, 200}, {30, 200}}}), IsEmpty());
    EXPECT_THAT(uncovered({{{10, 40}, {290, 40}, {290, 200}, {10, 200}}}), ElementsAre(0u));
    EXPECT_THAT(uncovered({{{30, 40}, {290, 40}, {310, 200}, {30, 200}}}), ElementsAre(1u)) << "one corner is enough";
    EXPECT_THAT(uncovered({{{30, 40}, {100, 40}, {100, 200}, {30, 200}}}), ElementsAre(1u)) << "only the other one lights it";
    EXPECT_THAT(uncovered({{{10, 10}, {310, 10}, {310, 230}, {10, 230}}}), ElementsAre(0u, 1u));
}

TEST(CanvasReach, has_a_middle_even_if_nothing_is_lit) {
    const ProjectorMap lit = columns(40, 240, 0), nothing = columns(0, 0, 0);
    const Corners corners = CanvasReach(reachCamera(), {{{}, &lit}}).middle();
    EXPECT_LT(glm::distance(corners[0], glm::dvec2(80, 60)), 3);
    EXPECT_LT(glm::distance(corners[2], glm::dvec2(200, 180)), 3);
    EXPECT_EQ(CanvasReach(reachCamera(), {{{}, &nothing}}).middle()[2], glm::dvec2(256, 192));
}

}  // namespace
}  // namespace fantascope::vision
