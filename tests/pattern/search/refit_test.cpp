#include "pattern/search/refit.h"

#include "pattern/search/measure.h"
#include "pattern/search_helpers.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace fantascope::pattern {
namespace {

// A soft disc of light on black, with a grey bar beside it.
GreyImage discAndBar(int width = 320, int height = 180) {
    GreyImage guide(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const double far = std::hypot((x - 0.4 * width) / (0.33 * width), (y - 0.5 * height) / (0.42 * height));
            guide.at(x, y) = static_cast<float>(std::clamp(1.4 - 1.4 * far, 0.0, 0.75));
            if (x > 0.82 * width && x < 0.95 * width) guide.at(x, y) = 0.4f;
        }
    return guide;
}

ShapePattern patternOf(const GreyImage& guide, int iterations = 150) {
    PatternSearch::Options options;
    options.instances = 500;
    options.iterations = iterations;
    ShapePattern pattern = withShapes({"leaf", "triangle"}, 5);
    pattern.compare = CompareSpace::Light;
    pattern = PatternSearch::run(guide, pattern, options, 1, never).pattern;
    for (ShapeInstance& instance : pattern.instances) instance.colour = glm::vec3(0.5f + 0.5f * float(instance.id % 2), 1, 1);
    return pattern;
}

PatternRefit refitted(const ShapePattern& pattern, const GreyImage& guide, const GreyImage& light) {
    return PatternRefit::of(pattern, guide, light, {.iterations = 100}, never);
}

constexpr glm::dvec2 kStain(0.6, 0.55);  // its middle, canvas heights
constexpr double kRadius = 0.22;

GreyImage stained(float darkest, float level = 0.7f) {
    GreyImage light(160, 90);
    for (int y = 0; y < light.height(); ++y)
        for (int x = 0; x < light.width(); ++x) {
            const double far = glm::distance((glm::dvec2(x, y) + 0.5) / 90.0, kStain) / kRadius;
            light.at(x, y) = level * (far < 1 ? darkest : 1.0f);
        }
    return light;
}

// Example failure: the search stirs a good pattern, so that a wall that did not change would get
// one exchange after the other.
TEST(PatternRefit, leaves_a_good_pattern_on_an_even_surface_alone) {
    const GreyImage guide = discAndBar();
    const ShapePattern pattern = patternOf(guide, 400);
    const PatternRefit refit = refitted(pattern, guide, stained(1));
    EXPECT_LE(refit.made + refit.removed + refit.changed, pattern.instances.size() / 20);
    EXPECT_LT(refit.gain(), 0.1);
    EXPECT_NEAR(refit.kept, 1, 0.03);
}

// Example failures: the search ignores the surface; it thins out everything instead of filling the
// stain; or it moves instances far from the stain.
TEST(PatternRefit, brings_instances_to_a_stain) {
    const GreyImage guide = discAndBar();
    const ShapePattern pattern = patternOf(guide);
    const GreyImage light = stained(0.55f);
    const PatternRefit refit = refitted(pattern, guide, light);
    EXPECT_GT(refit.gain(), 0.3);
    EXPECT_EQ(refit.toneBefore, toneOnSurface(pattern, guide, light));
    EXPECT_EQ(refit.toneAfter, toneOnSurface(refit.pattern, guide, light));
    const auto coveredIn = [&](const ShapePattern& of) {
        const GreyImage drawn = drawWhiteOnBlack(of, 320, 180);
        double covered = 0;
        for (int y = 0; y < 180; ++y)
            for (int x = 0; x < 320; ++x)
                if (glm::distance(glm::dvec2(x, y) / 180.0, kStain) < kRadius) covered += drawn.at(x, y);
        return covered;
    };
    EXPECT_GT(coveredIn(refit.pattern), 1.2 * coveredIn(pattern));
    EXPECT_GT(refit.made + refit.changed, 0u);
    EXPECT_LE(refit.pattern.instances.size(), 1.25 * double(pattern.instances.size()) + 1);

    std::map<std::uint32_t, ShapeInstance> before;
    for (const ShapeInstance& instance : pattern.instances) before[instance.id] = instance;
    std::size_t untouched = 0;
    for (const ShapeInstance& instance : refit.pattern.instances) {
        const auto found = before.find(instance.id);
        if (found == before.end()) {
            EXPECT_TRUE(instance.colour == glm::vec3(1) || instance.colour == glm::vec3(0.5f, 1, 1));
            continue;
        }
        EXPECT_EQ(instance.colour, found->second.colour);
        EXPECT_EQ(instance.group, found->second.group);
        EXPECT_EQ(instance.shape, found->second.shape);
        EXPECT_LT(glm::distance(instance.centre, found->second.centre), 0.15) << "nobody sees a shape fly across the wall";
        untouched += same({instance}, {found->second}) ? 1 : 0;
    }
    EXPECT_GT(untouched, pattern.instances.size() / 2);
}

// The second exchange on a wall that did not change: nothing is left to win.
TEST(PatternRefit, of_a_refit_wins_little_more) {
    const GreyImage guide = discAndBar();
    const GreyImage light = stained(0.55f);
    const PatternRefit first = refitted(patternOf(guide), guide, light);
    const PatternRefit second = refitted(first.pattern, guide, light);
    EXPECT_LT(second.gain(), 0.15);
}

// Example failure: the unit of the light counts, and a camera that is exposed brighter gets another
// pattern.
TEST(PatternRefit, does_not_depend_on_the_unit_of_the_light) {
    const GreyImage guide = discAndBar();
    const ShapePattern pattern = patternOf(guide);
    const PatternRefit one = refitted(pattern, guide, stained(0.5f, 0.5f)), other = refitted(pattern, guide, stained(0.5f, 2));
    EXPECT_TRUE(same(one.pattern.instances, other.pattern.instances));
    EXPECT_EQ(one.toneAfter, other.toneAfter);
}

// Where the drawing is white, no shape can add light: the rest is darkened, but not below the
// bound.
TEST(PatternRefit, keeps_the_share_of_the_light_that_it_must_keep) {
    GreyImage guide(320, 180);
    for (int y = 30; y < 150; ++y)
        for (int x = 30; x < 290; ++x) guide.at(x, y) = 1;
    const ShapePattern pattern = patternOf(guide);
    const GreyImage light = stained(0.4f);
    const auto keptWith = [&](double least) {
        return PatternRefit::of(pattern, guide, light, {.iterations = 100, .least = least}, never).kept;
    };
    EXPECT_LT(keptWith(0.5), 0.75);
    EXPECT_GT(keptWith(0.9), 0.84);
}

// A picture that is larger than the canvas. Example failure: what nobody sees counts as missing,
// and hides what the wall does.
TEST(PatternRefit, does_not_judge_what_lies_beyond_the_canvas) {
    const GreyImage guide = discAndBar();
    const ShapePattern pattern = patternOf(guide, 150);
    GreyImage light = stained(1);
    const double whole = toneOnSurface(pattern, guide, light);
    for (int y = 0; y < light.height(); ++y)
        for (int x = 0; x < light.width() / 3; ++x) light.at(x, y) = 0;
    EXPECT_LT(toneOnSurface(pattern, guide, light), 1.5 * whole);
    const PatternRefit refit = refitted(pattern, guide, light);
    EXPECT_LT(refit.made + refit.removed + refit.changed, pattern.instances.size() / 20);
}

TEST(PatternRefit, of_a_surface_that_gives_no_light_is_the_pattern) {
    const GreyImage guide = discAndBar();
    const ShapePattern pattern = patternOf(guide, 20);
    EXPECT_TRUE(same(refitted(pattern, guide, GreyImage(16, 9)).pattern.instances, pattern.instances));
}

}  // namespace
}  // namespace fantascope::pattern
