#include "render/canvas/blend_map.h"

#include "core/random.h"

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace fantascope::render {
namespace {

constexpr glm::ivec2 kSize{320, 180};

Projection projectionOf(const WarpShape& shape, double blackLevel = 0) {
    Projection projection{kSize, Warp::of(shape).value()};
    projection.light.blackLevel = blackLevel;
    return projection;
}

// Two pictures side by side on one canvas, overlapping by a fifth of a picture.
std::vector<Projection> sideBySide(double blackLevel = 0) {
    return {projectionOf({.part = {{0, 0}, {0.5556, 1}}, .corners = rectangleCorners(kSize.x, kSize.y)}, blackLevel),
            projectionOf({.part = {{0.4444, 0}, {1, 1}}, .corners = rectangleCorners(kSize.x, kSize.y)}, blackLevel)};
}

// Four crooked pictures on a canvas, two by two: one has a mesh, one is upside down, one mirrored,
// and no edges are parallel.
std::vector<Projection> crookedFour(double blackLevel) {
    const auto corners = [](double a, double b, double c, double d) {
        return std::array<glm::dvec2, 4>{{{10 + a, 12}, {300, 6 + b}, {312 - c, 172}, {6, 170 - d}}};
    };
    WarpMesh mesh{WarpMesh::Between::Smooth, {4, 3}, {}};
    Rng rng(5);
    for (int i = 0; i < 12; ++i) {
        const double x = rng.uniform(-6, 6), y = rng.uniform(-6, 6);
        mesh.offsets.emplace_back(x, y);
    }
    return {
        projectionOf({.part = {{0, 0}, {0.6, 0.58}}, .corners = corners(12, 3, 5, 9), .mesh = mesh}, blackLevel),
        projectionOf(
            {.part = {{0.42, 0}, {1, 0.62}}, .orientation = {Orientation::Flip::None, 2}, .corners = corners(0, 9, 8, 2)},
            blackLevel),
        projectionOf(
            {.part = {{0, 0.4}, {0.57, 1}}, .orientation = {Orientation::Flip::Horizontal, 0}, .corners = corners(4, 0, 2, 7)},
            2 * blackLevel),
        projectionOf({.part = {{0.39, 0.44}, {1, 1}}, .corners = corners(1, 7, 0, 0)}, blackLevel)};
}

std::vector<BlendMap> mapsOf(const std::vector<Projection>& projections) {
    std::vector<BlendMap> maps;
    for (std::size_t i = 0; i < projections.size(); ++i) maps.push_back(blendMap(projections, i, 2).value());
    return maps;
}

// The light of all projectors at a point of the canvas if the whole canvas should have `wanted`. It
// is interpolated between each projector's four nearest pixels.
double lightOn(glm::dvec2 canvas, double wanted, const std::vector<Projection>& projections, const std::vector<BlendMap>& maps) {
    double sum = 0;
    for (std::size_t i = 0; i < projections.size(); ++i) {
        const Projection& projection = projections[i];
        const glm::dvec2 pixel = projection.warp.projectorFromCanvas(canvas);
        if (pixel.x < 0 || pixel.y < 0 || pixel.x > kSize.x || pixel.y > kSize.y) continue;
        const CanvasPart& part = projection.warp.shape().part;
        const bool shown = canvas.x >= part.low.x && canvas.y >= part.low.y && canvas.x <= part.high.x && canvas.y <= part.high.y;
        const glm::dvec2 corner = glm::floor(pixel - 0.5), share = pixel - 0.5 - corner;
        const auto at = [&](int x, int y) {
            const glm::ivec2 place = glm::clamp(glm::ivec2(corner) + glm::ivec2(x, y), glm::ivec2(0), kSize - 1);
            return glm::dvec2(maps[i].at(place.x, place.y));
        };
        const glm::dvec2 map = glm::mix(glm::mix(at(0, 0), at(1, 0), share.x), glm::mix(at(0, 1), at(1, 1), share.x), share.y);
        const double black = projection.light.blackLevel;
        sum += black + (1 - black) * std::min(1.0, (shown ? wanted * map.x : 0) + map.y);
    }
    return sum;
}

// The difference between the canvas's brightest and darkest places. Places within about a pixel of
// an edge are left out: black levels step there, and the pixels of two projectors cannot coincide.
double unevenness(double wanted, const std::vector<Projection>& projections, const std::vector<BlendMap>& maps) {
    double least = INFINITY, most = 0;
    for (int y = 0; y < 90; ++y)
        for (int x = 0; x < 160; ++x) {
            const glm::dvec2 canvas((x + 0.5) / 160, (y + 0.5) / 90);
            const bool atEdge = std::any_of(projections.begin(), projections.end(), [&](const Projection& projection) {
                const glm::dvec2 pixel = projection.warp.projectorFromCanvas(canvas);
                const glm::dvec2 toEdge = glm::min(glm::abs(pixel), glm::abs(pixel - glm::dvec2(kSize)));
                const CanvasPart& part = projection.warp.shape().part;
                const glm::dvec2 toPart = glm::min(glm::abs(canvas - part.low), glm::abs(canvas - part.high)) * glm::dvec2(kSize);
                return std::min({toEdge.x, toEdge.y, toPart.x, toPart.y}) < 1.5;
            });
            if (atEdge) continue;
            const double light = lightOn(canvas, wanted, projections, maps);
            least = std::min(least, light);
            most = std::max(most, light);
        }
    return most - least;
}

TEST(BlendMap, is_nothing_for_one_projector_alone) {
    const std::vector<Projection> alone = {sideBySide()[0]};
    EXPECT_FALSE(blendMap(alone, 0, 1));
}

TEST(BlendMap, shares_the_light_of_an_overlap_and_nothing_else) {
    const auto projections = sideBySide();
    const auto maps = mapsOf(projections);
    EXPECT_EQ(maps[0].at(10, 90), glm::vec2(1, 0));
    EXPECT_EQ(maps[1].at(310, 90), glm::vec2(1, 0));
    // The overlap is a fifth of each picture, from column 256 on. In its middle both contribute a
    // half; the share is monotonic.
    EXPECT_NEAR(maps[0].at(288, 90).x, 0.5, 0.03);
    EXPECT_LT(maps[0].at(319, 90).x, 0.01);
    EXPECT_GT(maps[0].at(257, 90).x, 0.99);
    for (int x = 257; x < 320; ++x) EXPECT_LE(maps[0].at(x, 90).x, maps[0].at(x - 1, 90).x + 1e-6f) << x;
    // Top and bottom are edges of both pictures, so nothing is blended there. Example failure:
    // shares follow the distance to the nearest edge of any kind.
    for (const int y : {0, 45, 179}) EXPECT_NEAR(maps[0].at(288, y).x, maps[0].at(288, 90).x, 1e-4) << y;
}

TEST(BlendMap, makes_every_field_even_at_every_grey) {
    for (const bool crooked : {false, true})
        for (const double black : {0.0, 0.002, 0.02}) {
            const auto projections = crooked ? crookedFour(black) : sideBySide(black);
            const auto maps = mapsOf(projections);
            for (const double grey : {0.0, 0.01, 0.2, 0.5, 1.0})
                EXPECT_LT(unevenness(grey, projections, maps), 0.02)
                    << (crooked ? "four" : "two") << ", black " << black << ", grey " << grey;
        }
}

// Without the lift, the overlap's black would be twice as bright as the rest. The lifted black is
// as bright as the overlap's, not brighter.
TEST(BlendMap, lifts_the_blacks_around_an_overlap_to_its_own) {
    const auto projections = sideBySide(0.02);
    const auto maps = mapsOf(projections);
    EXPECT_EQ(maps[0].at(288, 90).y, 0) << "two projectors shine here";
    EXPECT_NEAR(lightOn({0.2, 0.5}, 0, projections, maps), 0.04, 1e-6);
    EXPECT_NEAR(lightOn({0.5, 0.5}, 0, projections, maps), 0.04, 1e-6);
    EXPECT_NEAR(lightOn({0.2, 0.5}, 1, projections, maps), 1, 1e-6);
}

// Shares begin and end without a kink, which would be more visible than the blend itself.
TEST(BlendMap, rises_smoothly) {
    const auto maps = mapsOf(sideBySide());
    const auto slope = [&](int x) { return double{maps[0].at(x + 1, 90).x} - double{maps[0].at(x, 90).x}; };
    double steepest = 0;
    for (int x = 250; x < 318; ++x) {
        steepest = std::max(steepest, std::abs(slope(x)));
        EXPECT_LT(std::abs(slope(x + 1) - slope(x)), 0.004) << x;
    }
    EXPECT_GT(steepest, 0.015);
}

TEST(BlendMap, masks_hide_what_they_cover_with_soft_edges) {
    Projection projection = sideBySide()[0];
    projection.masks.push_back({.polygon = {{100, 50}, {200, 50}, {200, 130}, {100, 130}}, .feather = 20});
    const BlendMap inside = blendMap(std::vector{projection}, 0, 1).value();
    EXPECT_EQ(inside.at(150, 90).x, 0);
    EXPECT_EQ(inside.at(50, 90).x, 1);
    EXPECT_NEAR(inside.at(100, 90).x, 0.5, 0.03);
    EXPECT_NEAR(inside.at(95, 90).x, 0.75, 0.05) << "half of the feather lies outside";
    projection.masks[0].hidesOutside = true;
    const BlendMap outside = blendMap(std::vector{projection}, 0, 1).value();
    for (int y = 0; y < kSize.y; ++y)
        for (int x = 0; x < kSize.x; ++x) ASSERT_NEAR(outside.at(x, y).x + inside.at(x, y).x, 1, 1e-5);
    // An image of half the size, dark on its right.
    auto image = std::make_shared<GreyImage>(160, 90, 1.0f);
    for (int y = 0; y < 90; ++y)
        for (int x = 80; x < 160; ++x) image->at(x, y) = 0.25f;
    projection.masks = {{.image = image}};
    const BlendMap pictured = blendMap(std::vector{projection}, 0, 1).value();
    EXPECT_EQ(pictured.at(40, 90).x, 1);
    EXPECT_EQ(pictured.at(300, 20).x, 0.25f);
}

TEST(BlendMap, is_the_same_on_any_number_of_threads) {
    const auto projections = crookedFour(0.01);
    EXPECT_EQ(blendMap(projections, 1, 1), blendMap(projections, 1, 4));
}

}  // namespace
}  // namespace fantascope::render
