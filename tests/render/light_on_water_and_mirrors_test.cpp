// Compares caustics and a mirror ball's light with optics.

#include "render/drawn_mirror_ball.h"
#include "render/output_renderer.h"
#include "render/scene.h"
#include "render/source/water.h"

#include "core/geometry.h"
#include "core/random.h"

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

namespace fantascope::render {
namespace {

constexpr glm::ivec2 kSize{320, 180};
constexpr glm::dvec2 kCanvas{16.0 / 3, 3};  // metres

double lightAt(const RgbaImage& image, int x, int y) {
    return double{linearFromSrgb(static_cast<float>(image.at(x, y).g) / 255)};
}

CausticsSource water(double waveHeight) { return {glm::vec3(0.08f), kCanvas, 1.2, 0.8, waveHeight, 3}; }

TEST(Caustics, are_even_light_under_still_water) {
    DrawnOutput output(kSize, rectangleCorners(kSize.x, kSize.y), {water(0)});
    for (const Rgba8 pixel : output.frame({{0, 1}}).pixels())
        ASSERT_NEAR(linearFromSrgb(static_cast<float>(pixel.g) / 255), 0.08, 0.003);
}

// The expectation is a Monte Carlo simulation: random rays are refracted at the surface and counted
// in tiles of the floor. Example failures: a picture that is upside down; waves that scatter where
// they should focus; light from nowhere.
TEST(Caustics, have_the_light_of_the_rays_that_land_there) {
    constexpr int kTile = 20, kColumns = kSize.x / kTile, kRows = kSize.y / kTile, kRays = 2'000'000;
    const Time time = std::chrono::seconds(5);
    const CausticsSource source = water(0.02);
    DrawnOutput output(kSize, rectangleCorners(kSize.x, kSize.y), {source});
    const RgbaImage& image = output.frame({{0, 1}}, time);

    const Water bent(source);
    std::vector<glm::vec4> waves(Water::kWaves);
    bent.at(time, waves);
    std::vector<double> landed(kColumns * kRows);
    Rng rng(4);
    const glm::dvec2 low(-bent.reach()), high = glm::dvec2(kCanvas.x / kCanvas.y, 1) + bent.reach();
    for (int ray = 0; ray < kRays; ++ray) {
        const glm::dvec2 surface(rng.uniform(low.x, high.x), rng.uniform(low.y, high.y));
        glm::dvec2 floor = surface;
        for (const glm::vec4& wave : waves) {
            const glm::dvec2 k(wave.x, wave.y);
            floor -= double{wave.z} * std::sin(glm::dot(k, surface) + double{wave.w}) * k;
        }
        const glm::ivec2 tile(glm::floor(floor * static_cast<double>(kRows)));
        if (tile.x >= 0 && tile.y >= 0 && tile.x < kColumns && tile.y < kRows)
            landed[static_cast<std::size_t>(tile.y * kColumns + tile.x)] += 1;
    }
    const double each = kRays / ((high.x - low.x) * (high.y - low.y)) / (kRows * kRows);  // per ray, in a tile under still water
    double squares = 0, contrast = 0, mean = 0;
    for (int row = 0; row < kRows; ++row)
        for (int column = 0; column < kColumns; ++column) {
            double light = 0;
            for (int y = 0; y < kTile; ++y)
                for (int x = 0; x < kTile; ++x) light += lightAt(image, column * kTile + x, row * kTile + y);
            light /= kTile * kTile * 0.08;
            const double wanted = landed[static_cast<std::size_t>(row * kColumns + column)] / each;
            squares += (light - wanted) * (light - wanted);
            contrast += (wanted - 1) * (wanted - 1);
            mean += light;
        }
    constexpr int kTiles = kColumns * kRows;
    std::printf("tiles: rms difference %.3f, contrast %.3f, mean %.3f\n", std::sqrt(squares / kTiles),
                std::sqrt(contrast / kTiles), mean / kTiles);
    EXPECT_GT(std::sqrt(contrast / kTiles), 0.08) << "the caustics are visible";
    EXPECT_LT(std::sqrt(squares / kTiles), 0.25 * std::sqrt(contrast / kTiles));
    EXPECT_NEAR(mean / kTiles, 1, 0.05);
}

// Every mirror reflects the lamp to where the law of reflection says, and nothing else is lit.
TEST(MirrorBall, throws_its_spots_by_the_law_of_reflection) {
    const MirrorBallSource source{glm::vec3(4), kCanvas, {0.3, 0.4, 2.2}, 0.3, 0.03, {2.5, 1.7, 1.1}, 0.02, 24};
    DrawnOutput output(kSize, rectangleCorners(kSize.x, kSize.y), {source});
    const RgbaImage& image = output.frame({{0, 1}}, std::chrono::seconds(3));

    const double angle = 2 * std::numbers::pi * 3 / 24, pixels = kSize.y / kCanvas.y;
    const auto turned = [&](glm::dvec3 v) {
        return glm::dvec3(v.x * std::cos(angle) + v.z * std::sin(angle), v.y, v.z * std::cos(angle) - v.x * std::sin(angle));
    };
    std::vector<glm::dvec2> spots;
    for (const gpu::SpotPainter::Facet& facet : mirrorFacets(source.radius, source.facet)) {
        const glm::dvec3 middle = source.ball + source.radius * turned(glm::dvec3(facet.outwards));
        const glm::dvec3 normal = turned(glm::dvec3(facet.normal)), incoming = glm::normalize(middle - source.lamp);
        if (glm::dot(incoming, normal) >= 0) continue;
        const glm::dvec3 outgoing = glm::reflect(incoming, normal);
        if (outgoing.z >= 0) continue;
        const glm::dvec3 wall = middle + outgoing * (middle.z / -outgoing.z);
        spots.push_back(glm::dvec2(kSize) / 2.0 + pixels * glm::dvec2(wall.x, -wall.y));
    }
    int seen = 0;
    for (const glm::dvec2 spot : spots) {
        if (spot.x < 2 || spot.y < 2 || spot.x >= kSize.x - 2 || spot.y >= kSize.y - 2) continue;
        ++seen;
        EXPECT_GT(lightAt(image, static_cast<int>(spot.x), static_cast<int>(spot.y)), 0.1) << spot.x << ", " << spot.y;
    }
    EXPECT_GT(seen, 20);
    for (int y = 0; y < kSize.y; ++y)
        for (int x = 0; x < kSize.x; ++x) {
            if (lightAt(image, x, y) < 0.01) continue;
            double nearest = INFINITY;
            for (const glm::dvec2 spot : spots) nearest = std::min(nearest, glm::distance(spot, glm::dvec2(x + 0.5, y + 0.5)));
            ASSERT_LT(nearest, 12) << "light without a mirror at " << x << ", " << y;
        }
}

TEST(MirrorBall, is_the_same_after_a_whole_turn) {
    DrawnOutput output(kSize, rectangleCorners(kSize.x, kSize.y),
                       {MirrorBallSource{glm::vec3(4), kCanvas, {0, 0, 2.2}, 0.3, 0.03, {2.5, 1.7, 1.1}, 0.02, 24}});
    const RgbaImage begin = output.frame({{0, 1}}, std::chrono::seconds(1));
    EXPECT_LE(difference(output.frame({{0, 1}}, std::chrono::seconds(25)), begin).most, 3);
    EXPECT_GT(difference(output.frame({{0, 1}}, std::chrono::seconds(2)), begin).most, 100);
}

}  // namespace
}  // namespace fantascope::render
