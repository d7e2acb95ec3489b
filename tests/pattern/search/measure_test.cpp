#include "pattern/search/measure.h"

#include "pattern/motion/pattern_motion.h"
#include "pattern/shape/elemental_shape.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace fantascope::pattern {
namespace {

// A square whose sides are sqrt(2) times its size, at rest.
ShapeInstance square(std::uint32_t id, glm::dvec2 centre, double size) {
    return {.id = id, .shape = 0, .group = 0, .centre = centre, .size = size, .rotation = {}, .colour = {1, 1, 1}};
}

// A canvas of 120 x 90 pixels with squares of 30 pixels.
constexpr double kThirtyPixels = 30.0 / 90 / std::numbers::sqrt2;

ShapePattern squares(std::initializer_list<glm::dvec2> centresInPixels) {
    ShapePattern pattern;
    pattern.width = 120, pattern.height = 90;
    pattern.shapes.push_back(loadShape("square").value());
    for (const glm::dvec2 centre : centresInPixels)
        pattern.instances.push_back(square(static_cast<std::uint32_t>(pattern.instances.size()), centre / 90.0, kThirtyPixels));
    return pattern;
}

LoopQuality loop(const ShapePattern& pattern, const GreyImage& guide, int threads = 1) {
    return LoopMeasure(pattern, guide, threads).in({}, 20);
}

// A square's corners are not on pixel edges, so its sides may be a pixel longer or shorter.
constexpr double kOnePixelASide = 0.07;

TEST(Measure, overlap_is_the_share_of_covered_pixels_that_are_covered_twice) {
    const GreyImage guide(120, 90);
    EXPECT_EQ(measure(squares({}), guide).overlap, 0);
    EXPECT_EQ(measure(squares({{30, 30}, {80, 60}}), guide).overlap, 0);
    EXPECT_EQ(measure(squares({{30, 30}, {30, 30}}), guide).overlap, 1);
    EXPECT_EQ(measure(squares({{30, 30}, {30, 30}, {30, 30}}), guide).overlap, 1);
    EXPECT_NEAR(measure(squares({{30, 30}, {45, 30}}), guide).overlap, 15.0 / 45, kOnePixelASide);
}

TEST(Measure, a_pattern_that_is_its_guide_differs_in_nothing) {
    const ShapePattern pattern = squares({{30, 30}, {80, 60}});
    const PatternQuality quality = measure(pattern, drawWhiteOnBlack(pattern, 120, 90));
    EXPECT_EQ(quality.z, 0);
    EXPECT_EQ(quality.zBound, 0);
    EXPECT_EQ(quality.tone, 0);
}

// Seen from afar, a black and white chequerboard is grey: z is as bad as it can be, and tone is
// good.
TEST(Measure, tone_sees_a_grey_where_z_sees_black_and_white) {
    ShapePattern chequer;
    chequer.width = 120, chequer.height = 90;
    chequer.shapes.push_back(loadShape("square").value());
    for (int row = 0; row < 45; ++row)
        for (int column = row % 2; column < 60; column += 2)
            chequer.instances.push_back(square(static_cast<std::uint32_t>(chequer.instances.size()),
                                               {(2 * column + 1) / 90.0, (2 * row + 1) / 90.0}, 2.0 / 90 / std::numbers::sqrt2));
    const PatternQuality quality = measure(chequer, GreyImage(120, 90, 0.5f));
    EXPECT_NEAR(quality.z, 0.5, 1e-4);
    EXPECT_LT(quality.tone, 0.05);
}

TEST(Measure, white_on_black_keeps_its_place_in_any_size) {
    const ShapePattern pattern = squares({{30, 30}});
    const GreyImage twice = drawWhiteOnBlack(pattern, 240, 180);
    EXPECT_EQ(twice.at(60, 60), 1);
    EXPECT_EQ(twice.at(36, 60), 1);
    EXPECT_EQ(twice.at(24, 60), 0);
    EXPECT_EQ(twice.at(180, 120), 0);
}

TEST(Measure, loop_z_is_z_when_nothing_moves_and_worse_when_the_shapes_leave_their_places) {
    ShapePattern pattern = squares({{30, 30}, {80, 60}});
    const GreyImage guide = drawWhiteOnBlack(pattern, 120, 90);
    EXPECT_GT(loop(pattern, guide, 1).z, 0.001);
    EXPECT_EQ(loop(pattern, guide, 1).z, loop(pattern, guide, 3).z);
    MotionSettings& motion = pattern.motion;
    for (AxisMotion* axis :
         {&motion.groupMajor, &motion.groupMinor, &motion.localTranslation, &motion.localTilt, &motion.localTurn})
        axis->magnitude = axis->range = 0;
    EXPECT_EQ(loop(pattern, guide, 1).z, 0);
}

TEST(Measure, loop_tone_without_movement_is_that_at_rest) {
    ShapePattern pattern = squares({{30, 30}, {80, 60}});
    pattern.width = 480, pattern.height = 360;
    GreyImage guide(480, 360);
    for (int y = 0; y < 360; ++y)
        for (int x = 0; x < 480; ++x) guide.at(x, y) = static_cast<float>(x) / 480;
    const double still = measure(pattern, guide).tone;
    EXPECT_NEAR(LoopMeasure(pattern, guide, 1).in({.strength = 0}, 1).tone, still, 0.02 * still);
    EXPECT_EQ(LoopMeasure(pattern, guide, 1).in({.strength = 0}, 1).localDisplacement, 0);
}

// The expectation is computed vertex by vertex at the same moments. Example failure: the groups'
// movement counts, or sizes are taken for widths.
TEST(Measure, local_displacement_is_how_far_the_vertices_stray_whatever_the_groups_do) {
    ShapePattern pattern = squares({{30, 30}, {80, 60}});
    pattern.instances[0].rotation = {0.3, -0.4, 1};
    const GreyImage guide(120, 90);
    constexpr int kMoments = 40;
    const double measured = LoopMeasure(pattern, guide, 2).in({}, kMoments).localDisplacement;

    ShapePattern local = pattern;
    local.motion.groupMajor.range = local.motion.groupMinor.range = 0;
    const PatternMotion motion(local);
    double squares = 0, count = 0;
    for (int moment = 0; moment < kMoments; ++moment) {
        std::vector<InstancePose> poses(2);
        motion.posesAt(motion.period() * moment / kMoments, {}, poses);
        for (std::size_t i = 0; i < 2; ++i)
            for (const glm::dvec3 vertex : pattern.shapes[0].mesh.vertices) {
                const ShapeInstance& rest = pattern.instances[i];
                const InstancePose at{rest.centre, rest.size, rest.rotation};
                const glm::dvec2 moved =
                    poses[i].centre - rest.centre + glm::dvec2(canvasFromShape(poses[i]) * vertex - canvasFromShape(at) * vertex);
                squares += glm::dot(moved, moved), count += 1;
            }
    }
    EXPECT_NEAR(measured, std::sqrt(squares / count) / kThirtyPixels, 1e-9);
    EXPECT_GT(measured, 0.01);
    pattern.motion.groupMajor.range = 0.3;
    EXPECT_NEAR(LoopMeasure(pattern, guide, 2).in({}, kMoments).localDisplacement, measured, 1e-9);
}

}  // namespace
}  // namespace fantascope::pattern
