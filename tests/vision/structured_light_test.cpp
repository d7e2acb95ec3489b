#include "vision/structured_light.h"

#include "tests/vision/projected_wall.h"

#include <gmock/gmock.h>

#include <cmath>

namespace fantascope::vision {
namespace {

using Pair = StructuredLight::Pair;

// Shows every pair once to the camera; the full pair `fulls` times.
LightDecoder decoded(ProjectedWall& wall, const StructuredLight& light, Rng& rng, int fulls = 3,
                     const std::function<double(int row)>& lamp = {}) {
    LightDecoder decoder(light, wall.camera.size);
    const auto take = [&](std::size_t pair) {
        const GreyImage picture = wall.seen(light.picture(pair, false, wall.gamma), rng, lamp);
        decoder.take(pair, picture, wall.seen(light.picture(pair, true, wall.gamma), rng, lamp));
    };
    for (int i = 1; i < fulls; ++i) take(0);
    for (std::size_t pair = 0; pair < light.pairs().size(); ++pair) take(pair);
    return decoder;
}

struct Errors {
    double rms = 0, max = 0;
    std::size_t known = 0;
};

Errors errorsOf(const ProjectorMap& map, const ProjectedWall& wall) {
    Errors errors;
    for (int y = 0; y < map.at.height(); ++y)
        for (int x = 0; x < map.at.width(); ++x) {
            if (!map.isKnown(x, y)) continue;
            const double error = glm::distance(glm::dvec2(map.at.at(x, y)), wall.projectorAt({x + 0.5, y + 0.5}));
            errors.rms += error * error;
            errors.max = std::max(errors.max, error);
            ++errors.known;
        }
    errors.rms = std::sqrt(errors.rms / static_cast<double>(std::max<std::size_t>(1, errors.known)));
    return errors;
}

// Every column and every row has a code of its own, next-door codes differ in one bit, and each
// complement is the rest of the light.
TEST(StructuredLight, names_every_stripe_by_a_gray_code) {
    const StructuredLight light({100, 36}, 16);
    EXPECT_EQ(light.bits(StructuredLight::Axis::Across), 4) << "13 stripes of 8 pixels";
    EXPECT_EQ(light.bits(StructuredLight::Axis::Down), 3) << "5 stripes";
    std::vector<int> codes(100, 0);
    for (std::size_t pair = 0; pair < light.pairs().size(); ++pair) {
        const RgbaImage picture = light.picture(pair, false, 1), complement = light.picture(pair, true, 1);
        for (int x = 0; x < 100; ++x) EXPECT_NEAR(picture.at(x, 20).r + complement.at(x, 20).r, 255, 1);
        const Pair& shown = light.pairs()[pair];
        if (shown.kind != Pair::Kind::Code || shown.axis != StructuredLight::Axis::Across) continue;
        for (int x = 0; x < 100; ++x)
            codes[static_cast<std::size_t>(x)] = codes[static_cast<std::size_t>(x)] * 2 + (picture.at(x, 0).r > 127);
    }
    for (int x = 1; x < 100; ++x) {
        const int changed = codes[static_cast<std::size_t>(x)] ^ codes[static_cast<std::size_t>(x - 1)];
        EXPECT_EQ(__builtin_popcount(static_cast<unsigned>(changed)), x % 8 == 0 ? 1 : 0) << x;
    }
}

// A bent surface of bricks under a slanted projector, with noise and another light: almost every
// pixel is known, to a fraction of a projector pixel.
TEST(LightDecoder, finds_the_projector_pixel_of_every_camera_pixel) {
    ProjectedWall wall = slantedWall();
    wall.relief = [](double x, double y) { return 0.15 * std::sin(1.7 * x) * std::cos(1.3 * y); };
    wall.reflectance = bricks;
    Rng rng(1);
    const StructuredLight light(wall.projector.size, 32);
    const LightDecoder decoder = decoded(wall, light, rng);
    const ProjectorMap map = decoder.map();
    EXPECT_GT(decoder.lit(), 25000u);
    const Errors errors = errorsOf(map, wall);
    EXPECT_GT(static_cast<double>(errors.known), 0.98 * static_cast<double>(map.lit));
    EXPECT_LT(errors.rms, 0.8);
}

// Example failure: a lamp that flickers with the mains between a picture and its complement is
// taken for the projector.
TEST(LightDecoder, is_not_misled_by_lamps_that_flicker) {
    ProjectedWall wall = slantedWall();
    Rng rng(2), moments(3);
    const StructuredLight light(wall.projector.size, 32);
    const auto lamp = [&, phase = 0.0](int row) mutable {
        if (row == 0) phase = moments.uniform(0, 6.283);
        return 0.06 + 0.05 * std::sin(phase + row * 0.02);
    };
    const ProjectorMap map = decoded(wall, light, rng, 3, lamp).map();
    const Errors errors = errorsOf(map, wall);
    EXPECT_GT(static_cast<double>(errors.known), 0.9 * static_cast<double>(map.lit));
    EXPECT_LT(errors.rms, 1.5);
}

// Somebody stands before the wall during one pair: the pixels there stay undecided, and the pair
// taken again fills them.
TEST(LightDecoder, a_pair_with_somebody_in_it_is_filled_by_another) {
    ProjectedWall wall = slantedWall();
    Rng rng(4);
    const StructuredLight light(wall.projector.size, 32);
    LightDecoder decoder(light, wall.camera.size);
    const auto seen = [&](std::size_t pair, bool complement) {
        return wall.seen(light.picture(pair, complement, wall.gamma), rng);
    };
    for (int i = 0; i < 3; ++i) decoder.take(0, seen(0, false), seen(0, true));
    EXPECT_EQ(decoder.undecided(0), 0);
    EXPECT_EQ(decoder.undecided(3), 1);
    for (std::size_t pair = 1; pair < light.pairs().size(); ++pair) {
        GreyImage picture = seen(pair, false);
        if (pair == 3)
            for (int y = 60; y < 220; ++y)
                for (int x = 200; x < 260; ++x) picture.at(x, y) = 0.02f;
        decoder.take(pair, picture, seen(pair, true));
    }
    EXPECT_GT(decoder.undecided(3), 0.03);
    const std::size_t before = decoder.map().known;
    const Errors without = errorsOf(decoder.map(), wall);
    EXPECT_LT(without.max, 8) << "a pixel that was hidden is not guessed";

    decoder.take(3, seen(3, false), seen(3, true));
    EXPECT_LT(decoder.undecided(3), 0.005);
    EXPECT_GT(decoder.map().known, before + 1000);
}

// Half of the wall is too bright for the camera. Example failure: it is decoded, wrongly.
TEST(LightDecoder, leaves_saturated_pixels_out) {
    ProjectedWall wall = slantedWall();
    wall.reflectance = [](double x, double) { return x < 0 ? 0.3 : 1.5; };
    Rng rng(6);
    const StructuredLight light(wall.projector.size, 32);
    const LightDecoder decoder = decoded(wall, light, rng);
    EXPECT_GT(decoder.saturated(), 10000u);
    EXPECT_GT(decoder.lit(), 10000u);
    const Errors errors = errorsOf(decoder.map(), wall);
    EXPECT_GT(errors.known, 10000u);
    EXPECT_LT(errors.rms, 1.5);
}

TEST(LightDecoder, says_that_nothing_is_lit) {
    ProjectedWall wall = slantedWall();
    wall.strength = 0;
    Rng rng(5);
    const StructuredLight light(wall.projector.size, 32);
    const LightDecoder decoder = decoded(wall, light, rng);
    EXPECT_LT(decoder.lit(), 20u);
    EXPECT_LT(decoder.map().known, 20u);
}

}  // namespace
}  // namespace fantascope::vision
