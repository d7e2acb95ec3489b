// The exchange of a source's pattern, as it is drawn.

#include "render/scene.h"
#include "render/source/pattern_rests.h"

#include "core/geometry.h"

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

namespace fantascope::render {
namespace {

using namespace std::chrono_literals;

constexpr glm::ivec2 kSize{320, 180};
constexpr show::SourceId kSource{0};

// The small pattern after an exchange: one instance is gone, one has moved and grown, one is new.
pattern::ShapePattern changed(pattern::ShapePattern pattern) {
    pattern::ShapeInstance added = pattern.instances.front();
    for (const pattern::ShapeInstance& instance : pattern.instances) added.id = std::max(added.id, instance.id + 1);
    added.centre = {0.4, 0.8};
    pattern.instances.erase(pattern.instances.begin() + 1);
    pattern.instances[2].centre += glm::dvec2(0.1, -0.05);
    pattern.instances[2].size *= 1.3;
    pattern.instances[2].rotation.z += 2 * std::numbers::pi + 0.4;
    pattern.instances.push_back(added);
    return pattern;
}

PatternSource exchanged(const pattern::ShapePattern& original, const pattern::ShapePattern& previous,
                        const pattern::ShapePattern& newest) {
    auto rests = std::make_shared<const PatternRests>(original, previous, newest);
    auto motion = std::make_shared<const pattern::PatternMotion>(*rests->all());
    return {rests->all(), std::move(motion), std::move(rests)};
}

show::LayerState layer(int number, float original, float previous) {
    show::LayerState layer{kSource, 1.0f};
    layer.exchange = {number, original, previous};
    return layer;
}

double lightOf(const RgbaImage& image) {
    double light = 0;
    for (const Rgba8 pixel : image.pixels()) light += linearFromSrgb(static_cast<float>(pixel.g) / 255);
    return light;
}

// Whoever swaps the patterns must not see it: the first frame is the old pattern, the last one the
// new one, and all instances sway on. Example failures: kept instances get another movement; the
// order in which they cover each other changes.
TEST(PatternExchange, leads_from_one_pattern_to_the_other) {
    const pattern::ShapePattern own = smallPattern(), first = changed(own), second = changed(first);
    const auto corners = keystone(kSize);
    DrawnOutput output(kSize, corners, {moving(own)}), plainFirst(kSize, corners, {moving(first)}),
        plainSecond(kSize, corners, {moving(second)}), plainOwn(kSize, corners, {moving(own)});
    ASSERT_TRUE(output.sink().makeCurrent());
    ASSERT_TRUE(output.renderer().exchange(kSource, 1, exchanged(own, own, first)));
    ASSERT_TRUE(output.renderer().exchange(kSource, 2, exchanged(own, first, second)));
    for (const Time time : {0ms, 12345ms}) {
        const auto looksLike = [&](DrawnOutput& plain, const show::LayerState& now) {
            const Difference off = difference(plain.frame({show::LayerState{kSource, 1.0f}}, time), output.frame({now}, time));
            return off.rms < 0.3;
        };
        EXPECT_TRUE(looksLike(plainOwn, layer(0, 1, 0)));
        EXPECT_TRUE(looksLike(plainOwn, layer(1, 1, 0)));
        EXPECT_TRUE(looksLike(plainFirst, layer(1, 0, 0)));
        EXPECT_TRUE(looksLike(plainFirst, layer(2, 0, 1)));
        EXPECT_TRUE(looksLike(plainSecond, layer(2, 0, 0)));
        EXPECT_TRUE(looksLike(plainOwn, layer(2, 1, 0))) << "taken back";
        EXPECT_FALSE(looksLike(plainOwn, layer(1, 0, 0)));
    }
}

// Nothing jumps on the way, and the light changes evenly. Example failure: a shape comes with its
// whole size, or its light comes all at the end.
TEST(PatternExchange, lets_shapes_grow_shrink_and_move_evenly) {
    const pattern::ShapePattern none = squareAt({0.3, 0.5}, 0.02, glm::vec3(1));
    pattern::ShapePattern more = none;
    more.instances.push_back(more.instances[0]);
    more.instances[1].id = more.instances[0].id + 1;
    more.instances[1].centre = {1.2, 0.5};
    more.instances[1].size = 0.3;
    const PatternRests rests(none, none, more);
    DrawnOutput output(kSize, rectangleCorners(kSize.x, kSize.y), {resting(none)});
    PatternSource source = resting(*rests.all());
    source.rests = std::make_shared<const PatternRests>(none, none, more);
    ASSERT_TRUE(output.renderer().exchange(kSource, 1, source));
    const double before = lightOf(output.frame({layer(1, 1, 0)})), after = lightOf(output.frame({layer(1, 0, 0)}));
    ASSERT_GT(after, 10 * before);
    for (const float share : {0.25f, 0.5f, 0.75f})
        EXPECT_NEAR(lightOf(output.frame({layer(1, 1 - share, 0)})), std::lerp(before, after, double(share)), 0.04 * after);
}

TEST(PatternRests, move_an_instance_to_its_new_rest_by_the_shorter_turn) {
    const pattern::ShapePattern own = smallPattern(), first = changed(own);
    const PatternRests rests(own, own, first);
    EXPECT_EQ(rests.all()->instances.size(), own.instances.size() + 1);
    std::vector<pattern::InstancePose> poses;
    for (const pattern::ShapeInstance& instance : rests.all()->instances)
        poses.push_back({instance.centre, instance.size, instance.rotation});
    rests.mix({1, 0.5f, 0}, poses);
    for (std::size_t i = 0; i < poses.size(); ++i) {
        const pattern::ShapeInstance& instance = rests.all()->instances[i];
        if (instance.id != first.instances[2].id) continue;
        const pattern::ShapeInstance& was = own.instances[3];
        ASSERT_EQ(was.id, instance.id);
        EXPECT_LT(glm::distance(poses[i].centre, was.centre + glm::dvec2(0.05, -0.025)), 1e-9);
        EXPECT_NEAR(std::remainder(poses[i].rotation.z - was.rotation.z, 2 * std::numbers::pi), 0.2, 1e-9);
    }
}

// A renderer that was made again, or a pattern that is lost, must not stop the show.
TEST(PatternExchange, shows_the_sources_own_pattern_until_it_is_ready) {
    const pattern::ShapePattern own = smallPattern();
    DrawnOutput output(kSize, keystone(kSize), {resting(own)}), plain(kSize, keystone(kSize), {resting(own)});
    const RgbaImage wanted = plain.frame({show::LayerState{kSource, 1.0f}});
    EXPECT_EQ(difference(wanted, output.frame({layer(3, 0, 0)})).most, 0);
    ASSERT_TRUE(output.sink().makeCurrent());
    EXPECT_TRUE(output.renderer().exchange({7}, 1, resting(own))) << "there is no such source";
}

}  // namespace
}  // namespace fantascope::render
