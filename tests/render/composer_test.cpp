// The steps between layers and projector: blending, colours, gamma, dither.

#include "render/scene.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace fantascope::render {
namespace {

using show::Blend;
using show::ComposedPicture;
using show::LayerState;
using show::OutputState;
using testing::AllOf;
using testing::Ge;
using testing::Le;

constexpr glm::ivec2 kSize{64, 36};
constexpr double kAspect = 16.0 / 9;

Projection plain() { return projectionTo(kSize, rectangleCorners(kSize.x, kSize.y)); }

int storedOf(double light) { return static_cast<int>(std::lround(255 * srgbFromLinear(static_cast<float>(light)))); }

// A square in the picture's middle, so that a layer has covered and uncovered places.
PatternSource square(float grey) { return resting(squareAt({kAspect / 2, 0.5}, 0.3, glm::vec3(grey))); }

struct Pixels {
    int covered = 0, uncovered = 0;  // stored green values in the middle and in a corner
};
Pixels pixelsOf(const RgbaImage& image) { return {image.at(kSize.x / 2, kSize.y / 2).g, image.at(2, 2).g}; }

// The expectations follow from each mode's definition in linear light, for a square of light 0.5
// over 0.4.
TEST(Composer, blends_layers_in_linear_light) {
    DrawnOutput output(plain(), {SolidSource{glm::vec3(0.4f)}, square(0.5f)});
    const auto drawn = [&](Blend blend, float opacity) {
        return pixelsOf(output.frame(OutputState{{{0, 1.0f}, {1, opacity, blend}}, {{0, 2, 1.0f}}}));
    };
    struct Case {
        Blend blend;
        double whole, half;  // expected light in the square at opacity 1 and 0.5
    };
    for (const Case& wanted :
         {Case{Blend::Add, 0.9, 0.65}, {Blend::Over, 0.5, 0.45}, {Blend::Multiply, 0.2, 0.3}, {Blend::Screen, 0.7, 0.55}}) {
        for (const auto& [opacity, light] : {std::pair(1.0f, wanted.whole), {0.5f, wanted.half}}) {
            const Pixels pixels = drawn(wanted.blend, opacity);
            EXPECT_NEAR(pixels.covered, storedOf(light), 1) << static_cast<int>(wanted.blend) << " at " << opacity;
            EXPECT_NEAR(pixels.uncovered, storedOf(0.4), 1) << "a layer changes nothing where it covers nothing";
        }
    }
}

// The order of any number of layers is kept. Layers beyond one pass are carried on without loss.
TEST(Composer, keeps_the_order_of_any_number_of_layers) {
    DrawnOutput output(plain(), {SolidSource{glm::vec3(0.8f)}, square(0.5f), SolidSource{glm::vec3(0.25f)}, square(0.125f)});
    const OutputState state{
        {{0, 1.0f}, {1, 1.0f, Blend::Multiply}, {2, 1.0f, Blend::Screen}, {3, 0.5f, Blend::Over}, {2, 0.5f, Blend::Multiply}},
        {{0, 5, 1.0f}}};
    const auto screen = [](double a, double b) { return a + b - a * b; };
    const double covered = (screen(0.8 * 0.5, 0.25) / 2 + 0.125 / 2) * (0.5 + 0.25 / 2),
                 around = screen(0.8, 0.25) * (0.5 + 0.25 / 2);
    const Pixels pixels = pixelsOf(output.frame(state));
    EXPECT_NEAR(pixels.covered, storedOf(covered), 1);
    EXPECT_NEAR(pixels.uncovered, storedOf(around), 1);
}

// A crossfade of two composed looks that share one light: each picture is composed separately and
// then weighted with its share.
TEST(Composer, adds_pictures_with_their_shares) {
    DrawnOutput output(plain(), {SolidSource{glm::vec3(0.1f)}, SolidSource{glm::vec3(0.8f)}, square(0.5f), square(0.25f)});
    const OutputState state{{{0, 1.0f}, {1, 1.0f}, {2, 1.0f, Blend::Multiply}, {1, 0.5f}, {3, 1.0f, Blend::Over}},
                            {{1, 3, 0.25f}, {3, 5, 0.75f}}};
    const Pixels pixels = pixelsOf(output.frame(state));
    EXPECT_NEAR(pixels.covered, storedOf(0.1 + 0.25 * 0.8 * 0.5 + 0.75 * 0.25), 1);
    EXPECT_NEAR(pixels.uncovered, storedOf(0.1 + 0.25 * 0.8 + 0.75 * 0.4), 1);
}

TEST(Composer, tints_in_linear_light) {
    Projection projection = plain();
    projection.light.white = {1, 0.5, 0.25};
    projection.light.brightness = 0.5;
    DrawnOutput output(projection, {SolidSource{glm::vec3(0.8f)}});
    const Rgba8 pixel = output.frame({{0, 1}}).at(5, 5);
    EXPECT_NEAR(pixel.r, storedOf(0.4), 1);
    EXPECT_NEAR(pixel.g, storedOf(0.2), 1);
    EXPECT_NEAR(pixel.b, storedOf(0.1), 1);
}

// A projector of gamma 2.2 turns each sent value into the wanted light.
TEST(Composer, sends_the_projector_values_of_its_own_gamma) {
    Projection projection = plain();
    projection.light.gamma = 2.2;
    for (const float light : {0.0f, 0.01f, 0.2f, 0.5f, 1.0f}) {
        DrawnOutput output(projection, {SolidSource{glm::vec3(light)}});
        const double stored = output.frame({{0, 1}}).at(5, 5).g;
        EXPECT_NEAR(stored, 255 * std::pow(light, 1 / 2.2), 1.5) << light;
    }
}

// The table maps stored sRGB values, as in the programs that write such tables.
TEST(Composer, looks_colours_up_in_the_table) {
    const auto turned = [](glm::vec3 stored) { return glm::vec3(stored.g, 1 - stored.b, 0.5f * stored.r); };
    ColourCube cube;
    cube.side = 9;
    for (int i = 0; i < 9 * 9 * 9; ++i) cube.colours.push_back(turned(glm::vec3(i % 9, i / 9 % 9, i / 81) / 8.0f));
    Projection projection = plain();
    projection.light.cube = std::make_shared<const ColourCube>(cube);
    for (const glm::vec3 colour : {glm::vec3(0.1f, 0.2f, 0.9f), glm::vec3(1, 0, 0.5f), glm::vec3(0.03f, 0.6f, 0.3f)}) {
        DrawnOutput output(projection, {SolidSource{colour}});
        const Rgba8 pixel = output.frame({{0, 1}}).at(5, 5);
        const glm::vec3 wanted = 255.0f * turned({srgbFromLinear(colour.r), srgbFromLinear(colour.g), srgbFromLinear(colour.b)});
        EXPECT_NEAR(pixel.r, wanted.r, 1.5f);
        EXPECT_NEAR(pixel.g, wanted.g, 1.5f);
        EXPECT_NEAR(pixel.b, wanted.b, 1.5f);
    }
}

// A light between two stored values becomes a mixture of both with the same mean, without a visible
// pattern: all rows and columns have about the same number of each.
TEST(Composer, dithers_between_two_values_and_keeps_the_mean) {
    Projection projection = projectionTo({256, 256}, rectangleCorners(256, 256));
    projection.light.dither = true;
    for (const double between : {40.25, 40.5, 40.8}) {
        // The layer's own 8 bits must not limit the light: white is exact in them, and the opacity
        // does the rest.
        const float light = linearFromSrgb(static_cast<float>(between / 255));
        DrawnOutput output(projection, {SolidSource{glm::vec3(1)}});
        const RgbaImage& image = output.frame({{0, light}});
        double sum = 0;
        std::map<int, int> values;
        std::vector<double> rows(256, 0.0), columns(256, 0.0);
        for (int y = 0; y < 256; ++y)
            for (int x = 0; x < 256; ++x) {
                const int value = image.at(x, y).g;
                ++values[value];
                sum += value;
                rows[static_cast<std::size_t>(y)] += value / 256.0;
                columns[static_cast<std::size_t>(x)] += value / 256.0;
            }
        EXPECT_EQ(values.size(), 2u) << between;
        EXPECT_NEAR(sum / (256 * 256), between, 0.02);
        for (const auto* means : {&rows, &columns})
            for (const double mean : *means) EXPECT_NEAR(mean, between, 0.12);
    }
}

// Storable values are not dithered, above all black: single sparkling pixels on a dark wall are
// worse than any step.
TEST(Composer, leaves_what_can_be_stored_as_it_is) {
    Projection projection = plain();
    projection.light.dither = true;
    DrawnOutput output(projection, {SolidSource{glm::vec3(1)}});
    for (const int value : {0, 1, 2, 17, 128, 254, 255})
        for (const Rgba8 pixel : output.frame({{0, linearFromSrgb(static_cast<float>(value) / 255)}}).pixels())
            ASSERT_EQ(pixel.g, value);
}

// A slow gradient, as in a wide penumbra, shows steps without dither. With dither, the mean over a
// few pixels follows the light.
TEST(Composer, hides_the_steps_of_a_gradient) {
    constexpr glm::ivec2 kWide{512, 64};
    const auto largestMiss = [&](bool dither) {
        Projection projection = projectionTo(kWide, rectangleCorners(kWide.x, kWide.y));
        projection.light.dither = dither;
        BlendMap ramp(kWide.x, kWide.y);
        const auto lightAt = [](double x) { return 0.02 + 0.01 * x / 512; };
        for (int y = 0; y < kWide.y; ++y)
            for (int x = 0; x < kWide.x; ++x) ramp.at(x, y) = glm::vec2(lightAt(x + 0.5), 0);
        DrawnOutput output(projection, {SolidSource{glm::vec3(1)}}, std::make_shared<const BlendMap>(std::move(ramp)));
        const RgbaImage& image = output.frame({{0, 1}});
        double largest = 0;
        constexpr int kBlock = 16;
        for (int left = 0; left + kBlock <= kWide.x; left += kBlock) {
            double sum = 0;
            for (int y = 0; y < kWide.y; ++y)
                for (int x = left; x < left + kBlock; ++x) sum += image.at(x, y).g;
            const double wanted = 255 * srgbFromLinear(static_cast<float>(lightAt(left + kBlock / 2.0)));
            largest = std::max(largest, std::abs(sum / (kBlock * kWide.y) - wanted));
        }
        return largest;
    };
    const double plainMiss = largestMiss(false), ditheredMiss = largestMiss(true);
    std::printf("mean of 16 columns: at most %.2f of a step off without the dither, %.2f with it\n", plainMiss, ditheredMiss);
    EXPECT_GT(plainMiss, 0.3);
    EXPECT_LT(ditheredMiss, 0.1);
}

// A technician changes settings while the show runs.
TEST(Composer, follows_new_settings_and_goes_back) {
    DrawnOutput output(plain(), {SolidSource{glm::vec3(0.5f)}});
    const RgbaImage before = output.frame({{0, 1}});
    Projection darker = plain();
    darker.light.brightness = 0.5;
    ASSERT_TRUE(output.renderer().follow(darker, nullptr));
    EXPECT_NEAR(output.frame({{0, 1}}).at(5, 5).g, storedOf(0.25), 1);
    ASSERT_TRUE(output.renderer().follow(plain(), nullptr));
    EXPECT_EQ(output.frame({{0, 1}}), before);
}

// The overlay lies on the signal itself: colours, blend and warp do not affect it, and the show is
// visible around it.
TEST(SettingUp, lays_the_overlay_over_all_pixel_by_pixel) {
    Projection projection = projectionTo(kSize, keystone(kSize));
    projection.light.gamma = 2.2;
    projection.light.brightness = 0.3;
    DrawnOutput output(projection, {SolidSource{glm::vec3(1)}},
                       std::make_shared<const BlendMap>(kSize.x, kSize.y, glm::vec2(0.5f, 0)));
    const RgbaImage shown = output.frame({{0, 1}});
    RgbaImage overlay(kSize.x, kSize.y, {0, 0, 0, 0});
    for (int x = 0; x < kSize.x; ++x) overlay.at(x, 3) = {static_cast<std::uint8_t>(x), 7, 200, 255};
    overlay.at(40, 20) = {50, 50, 50, 128};
    ASSERT_TRUE(output.renderer().setUp(&overlay, nullptr));
    const RgbaImage& drawn = output.frame({{0, 1}});
    for (int y = 0; y < kSize.y; ++y)
        for (int x = 0; x < kSize.x; ++x) {
            const bool covered = y == 3, mixed = x == 40 && y == 20;
            const Rgba8 wanted = covered ? Rgba8{static_cast<std::uint8_t>(x), 7, 200, 255} : shown.at(x, y);
            if (mixed) continue;
            ASSERT_EQ(drawn.at(x, y), wanted) << x << ", " << y;
        }
    EXPECT_NEAR(drawn.at(40, 20).g, 50 + shown.at(40, 20).g * 127 / 255, 1);
    ASSERT_TRUE(output.renderer().setUp(nullptr, nullptr));
    EXPECT_EQ(output.frame({{0, 1}}), shown);
}

// A grey ramp is for judging the colours: it passes all colour settings and fills the picture
// whatever the warp.
TEST(SettingUp, shows_a_card_through_the_colours_but_not_the_warp) {
    Projection projection = projectionTo(kSize, keystone(kSize));
    projection.light.gamma = 2.2;
    projection.light.brightness = 0.5;
    DrawnOutput output(projection, {SolidSource{glm::vec3(1)}});
    RgbaImage card(kSize.x, kSize.y);
    for (int y = 0; y < kSize.y; ++y)
        for (int x = 0; x < kSize.x; ++x)
            card.at(x, y) = {static_cast<std::uint8_t>(4 * x), 0, static_cast<std::uint8_t>(7 * y), 255};
    ASSERT_TRUE(output.renderer().setUp(nullptr, &card));
    const RgbaImage& drawn = output.frame({{0, 1}});
    const auto sent = [](int stored) {
        return 255 * std::pow(0.5 * static_cast<double>(linearFromSrgb(static_cast<float>(stored) / 255)), 1 / 2.2);
    };
    for (int y = 0; y < kSize.y; y += 5)
        for (int x = 0; x < kSize.x; x += 3) {
            ASSERT_NEAR(drawn.at(x, y).r, sent(4 * x), 2) << x << ", " << y;
            ASSERT_NEAR(drawn.at(x, y).b, sent(7 * y), 2) << x << ", " << y;
        }
}

}  // namespace
}  // namespace fantascope::render
