#include "pattern/search/motion_fit.h"

#include "pattern/search/measure.h"
#include "pattern/shape/elemental_shape.h"

#include <gtest/gtest.h>

namespace fantascope::pattern {
namespace {

constexpr int kWidth = 320, kHeight = 180;

// Shapes on a grid of `columns` columns, a little apart, on the whole canvas or only on its middle
// third.
ShapePattern gridOf(const std::string& shape, int columns, bool middleOnly) {
    ShapePattern pattern;
    pattern.width = kWidth, pattern.height = kHeight;
    pattern.seed = 3;
    pattern.motion.frames = 240;
    pattern.shapes.push_back(loadShape(shape).value());
    const double step = pattern.aspect() / columns;
    for (double y = step / 2; y < 1; y += step)
        for (double x = step / 2; x < pattern.aspect(); x += step) {
            if (middleOnly && std::abs(x - pattern.aspect() / 2) > pattern.aspect() / 6) continue;
            ShapeInstance instance;
            instance.id = static_cast<std::uint32_t>(pattern.instances.size());
            instance.centre = {x, y};
            instance.size = 0.35 * step;  // so far apart that their own movement alone hardly changes the tone
            pattern.instances.push_back(instance);
        }
    pattern.groups = 4;
    for (ShapeInstance& instance : pattern.instances) instance.group = instance.id % pattern.groups;
    return pattern;
}

GreyImage guideOf(const ShapePattern& pattern) { return drawWhiteOnBlack(pattern, kWidth, kHeight); }

// This holds for any shape and size. Example failure: an absolute range, which moves small shapes
// over each other and large ones hardly at all.
TEST(MotionFit, lets_shapes_of_any_size_stray_by_the_same_share_of_it) {
    for (const char* shape : {"triangle", "circle", "leaf"})
        for (const int columns : {12, 40}) {
            ShapePattern pattern = gridOf(shape, columns, false);
            const GreyImage guide = guideOf(pattern);
            pattern.motion = fittedMotion(pattern, guide, 2);
            const double displacement = LoopMeasure(pattern, guide, 2).in({}, 100).localDisplacement;
            EXPECT_GE(displacement, 0.15) << shape << ", " << columns;
            EXPECT_LT(displacement, 0.16) << shape << ", " << columns;
        }
}

// The tone of a white band in the dark shows every shift of its edges. Example failure: groups move
// without regard to the drawing.
TEST(MotionFit, lets_groups_move_as_far_as_the_tone_allows) {
    ShapePattern band = gridOf("square", 30, true), single = band;
    single.instances.resize(1);
    const GreyImage guide = guideOf(band);
    band.motion = fittedMotion(band, guide, 2);
    single.motion = fittedMotion(single, guideOf(single), 2);
    EXPECT_LT(band.motion.groupMajor.range, 0.8 * band.meanSize());
    EXPECT_NEAR(single.motion.groupMajor.range, single.meanSize(), 1e-5);
    const LoopMeasure loop(band, guide, 2);
    const double added = loop.in({}, 100).tone - loop.in({.strength = 0}, 1).tone;
    EXPECT_LT(added, 0.01);
    EXPECT_GT(added, 0.007);  // and not much less than allowed
}

TEST(MotionFit, leaves_everything_but_magnitudes_and_ranges_alone) {
    ShapePattern pattern = gridOf("triangle", 20, false);
    pattern.motion.localTurn.naturalFrequency = 0.123;
    pattern.motion.direction = 1;
    const MotionSettings fitted = fittedMotion(pattern, guideOf(pattern), 1);
    EXPECT_EQ(fitted.localTurn.naturalFrequency, 0.123);
    EXPECT_EQ(fitted.direction, 1);
    EXPECT_EQ(fitted.frames, pattern.motion.frames);
    EXPECT_EQ(fitted.groupMajor.damping, pattern.motion.groupMajor.damping);
}

TEST(MotionFit, is_the_same_on_any_number_of_threads) {
    const ShapePattern pattern = gridOf("leaf", 20, true);
    const GreyImage guide = guideOf(pattern);
    const MotionSettings one = fittedMotion(pattern, guide, 1), many = fittedMotion(pattern, guide, 5);
    EXPECT_EQ(one.groupMajor.range, many.groupMajor.range);
    EXPECT_EQ(one.localTurn.range, many.localTurn.range);
}

TEST(MotionFit, of_an_empty_pattern_is_no_movement) {
    ShapePattern pattern = gridOf("leaf", 20, false);
    pattern.instances.clear();
    EXPECT_EQ(fittedMotion(pattern, GreyImage(kWidth, kHeight), 1).localTranslation.range, 0);
}

}  // namespace
}  // namespace fantascope::pattern
