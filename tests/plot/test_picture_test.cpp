#include "edit_views.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fantascope::plot {
namespace {

using Flip = Orientation::Flip;

// The distance of a drawn canvas line from where the warp has it, at a point of the line, across
// the pixels. kNothing if there is no light; nothing if there are other lines nearby.
constexpr double kNothing = 1e9;
std::optional<double> missAt(const RgbaImage& picture, const Warp& warp, glm::dvec2 canvas, glm::dvec2 along) {
    constexpr double kReach = 0.04;
    const glm::dvec2 direction =
        warp.projectorFromCanvas(canvas + 1e-4 * along) - warp.projectorFromCanvas(canvas - 1e-4 * along);
    const int axis = std::abs(direction.y) > std::abs(direction.x) ? 0 : 1,
              other = 1 - axis;  // the axis along which the light is measured
    const glm::dvec2 near = warp.projectorFromCanvas(canvas);
    if (near.x < 20 || near.y < 20 || near.x > picture.width() - 20 || near.y > picture.height() - 20) return std::nullopt;
    // The line's point in the middle of a pixel row, by bisection.
    const double row = std::floor(near[other]) + 0.5;
    double low = -kReach, high = kReach;
    const bool grows = direction[other] > 0;
    for (int i = 0; i < 60; ++i) {
        const double middle = (low + high) / 2;
        ((warp.projectorFromCanvas(canvas + middle * along)[other] < row) == grows ? low : high) = middle;
    }
    const double wanted = warp.projectorFromCanvas(canvas + low * along)[axis];
    double light = 0, moment = 0;
    int runs = 0;
    bool was = false;
    for (int i = -8; i <= 8; ++i) {
        glm::ivec2 pixel;
        pixel[axis] = int(std::floor(wanted)) + i, pixel[other] = int(row);
        const double value = lightOf(picture, pixel.x, pixel.y);
        light += value, moment += value * (pixel[axis] + 0.5);
        runs += value > 0 && !was;
        was = value > 0;
    }
    if (light == 0) return kNothing;
    if (runs > 1 || light > 450)
        return std::nullopt;  // a line has at most 1.5 pixels of 204; a circle that touches it adds to that
    return moment / light - wanted;
}

// A technician moves a mesh point until a line lies on a ledge, so the line must be where the show
// will be.
TEST(TestPictureGrid, lies_where_the_warp_puts_the_canvas) {
    struct Case {
        const char* what;
        WarpShape shape;
        double aspect = kAspect;
    };
    const std::array<Case, 6> cases{{
        {"keystone", {.corners = kKeystone}},
        {"smooth mesh", {.corners = kKeystone, .mesh = aMesh(WarpMesh::Between::Smooth)}},
        {"straight mesh", {.corners = kKeystone, .mesh = aMesh(WarpMesh::Between::Straight)}},
        {"rear projection",
         {.orientation = {Flip::Horizontal, 0}, .corners = kKeystone, .mesh = aMesh(WarpMesh::Between::Smooth)}},
        {"on its side",
         {.orientation = {Flip::Vertical, 1}, .corners = kKeystone, .mesh = aMesh(WarpMesh::Between::Smooth)},
         9.0 / 16},
        {"a part of a wide canvas", {.part = {{0.3, 0}, {0.75, 1}}, .corners = kKeystone}, 4.1},
    }};
    for (const Case& test : cases) {
        SCOPED_TRACE(test.what);
        const Projection output = projection(test.shape);
        const RgbaImage picture = drawEditView({.projection = output, .aspect = test.aspect, .picture = TestPicture::Grid});
        const CanvasPart& part = test.shape.part;
        int measured = 0, unclear = 0;
        const auto look = [&](glm::dvec2 canvas, glm::dvec2 along) {
            const auto miss = missAt(picture, output.warp, canvas, along);
            if (!miss) return void(++unclear);
            ++measured;
            EXPECT_LT(std::abs(*miss), 0.25) << "at " << canvas.x << ", " << canvas.y << " of the canvas";
        };
        for (int i = 0; i < 100; ++i)
            for (int j = 0; j < 100; ++j) {
                // Halfway between two crossings.
                const glm::dvec2 upright(0.1 * i / test.aspect, 0.1 * j + 0.05), level((0.1 * i + 0.05) / test.aspect, 0.1 * j);
                const auto isInside = [&](glm::dvec2 p) {
                    return glm::all(glm::greaterThan(p, part.low + 0.02)) && glm::all(glm::lessThan(p, part.high - 0.02));
                };
                if (isInside(upright)) look(upright, {0, 1});
                if (isInside(level)) look(level, {1, 0});
            }
        EXPECT_GT(measured, 100);
        EXPECT_LT(unclear, measured / 6);
    }
}

TEST(TestPictureGrid, has_circles_that_are_round_whatever_part_of_the_canvas_is_shown) {
    // Half of a 32 : 9 canvas fills 16 : 9.
    const Projection output = projection({.part = {{0.5, 0}, {1, 1}}, .corners = rectangleCorners(kSize.x, kSize.y)});
    const RgbaImage picture = drawEditView({.projection = output, .aspect = 2 * kAspect, .picture = TestPicture::Grid});
    for (int i = 0; i < 40; ++i) {
        const double angle = 2 * std::numbers::pi * i / 40;
        const glm::ivec2 at(glm::dvec2(kSize) / 2.0 + 0.4 * kSize.y * glm::dvec2(std::cos(angle), std::sin(angle)));
        int brightest = 0;
        for (int y = -1; y <= 1; ++y)
            for (int x = -1; x <= 1; ++x) brightest = std::max(brightest, lightOf(picture, at.x + x, at.y + y));
        EXPECT_GT(brightest, 170) << "at " << i * 9 << " degrees";
    }
}

// These are the pixels that a projector's overscan cuts off.
TEST(TestPictureCorners, lights_all_outermost_pixels) {
    const Projection output = projection({.corners = kKeystone});
    for (const TestPicture which : {TestPicture::Corners, TestPicture::Identify, TestPicture::Focus}) {
        const RgbaImage picture = drawEditView({.projection = output, .picture = which});
        for (int x = 0; x < kSize.x; ++x)
            ASSERT_EQ(std::pair(lightOf(picture, x, 0), lightOf(picture, x, kSize.y - 1)), std::pair(255, 255)) << x;
        for (int y = 0; y < kSize.y; ++y)
            ASSERT_EQ(std::pair(lightOf(picture, 0, y), lightOf(picture, kSize.x - 1, y)), std::pair(255, 255)) << y;
        // The rim is one pixel wide.
        EXPECT_TRUE(which == TestPicture::Focus || lightOf(picture, 20, 1) == 0);
    }
}

// The mark is on the picture's last pixel, not on the one next to it.
TEST(TestPictureCorners, crosses_the_pixels_in_which_the_corners_lie) {
    const Projection output = projection({.corners = kKeystone});
    const RgbaImage picture = drawEditView({.projection = output, .picture = TestPicture::Corners});
    const std::array<glm::ivec2, 4> pixels{{{103, 41}, {1810, 12}, {1702, 1032}, {61, 987}}},
        outwards{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
    for (std::size_t i = 0; i < 4; ++i) {
        // The arm outside the picture, where nothing else is drawn, is a pixel wide.
        const glm::ivec2 arm = pixels[i] + glm::ivec2(45 * outwards[i].x, 0);
        EXPECT_EQ(lightOf(picture, arm.x, arm.y), 255) << "corner " << i;
        EXPECT_EQ(lightOf(picture, arm.x, arm.y - 1), 0) << "corner " << i;
        EXPECT_EQ(lightOf(picture, arm.x, arm.y + 1), 0) << "corner " << i;
        const int end = pixels[i].y + 45 * outwards[i].y;
        if (end < 2 || end > kSize.y - 3) continue;
        EXPECT_EQ(lightOf(picture, pixels[i].x, end), 255) << "corner " << i;
        EXPECT_EQ(lightOf(picture, pixels[i].x - 1, end), 0) << "corner " << i;
        EXPECT_EQ(lightOf(picture, pixels[i].x + 1, end), 0) << "corner " << i;
    }
}

// Blurred by a pixel, these lines become grey; drawn through the warp, they would be grey already.
TEST(TestPictureFocus, has_pairs_of_lines_a_pixel_wide_in_both_directions_whatever_the_warp) {
    const Projection output = projection({.corners = kKeystone, .mesh = aMesh(WarpMesh::Between::Smooth)});
    const RgbaImage picture = drawEditView({.projection = output, .picture = TestPicture::Focus});
    int upright = 0, level = 0, looks = 0;
    for (int y = 12; y < kSize.y - 12; y += 20)
        for (int x = 12; x < kSize.x - 12; x += 20, ++looks) {
            const auto alternate = [&](glm::ivec2 step) {
                for (int i = 0; i < 6; ++i) {
                    const glm::ivec2 a = glm::ivec2(x, y) + i * step, b = a + step;
                    if (lightOf(picture, a.x, a.y) + lightOf(picture, b.x, b.y) != 255) return false;
                }
                return true;
            };
            upright += alternate({1, 0}), level += alternate({0, 1});
        }
    EXPECT_GT(upright, looks / 4);
    EXPECT_GT(level, looks / 4);
}

TEST(ColourCard, has_the_bars_of_the_standard_at_75_percent_over_patches_at_100) {
    for (const glm::ivec2 size : {glm::ivec2(64, 36), glm::ivec2(640, 360), glm::ivec2(1920, 1080), glm::ivec2(3840, 2160)}) {
        const RgbaImage card = drawColourCard(TestPicture::Bars, size);
        ASSERT_EQ(glm::ivec2(card.width(), card.height()), size);
        const auto at = [&](double x, double y) { return card.at(int(x * size.x), int(y * size.y)); };
        const std::array<Rgba8, 7> bars{
            {{191, 191, 191}, {191, 191, 0}, {0, 191, 191}, {0, 191, 0}, {191, 0, 191}, {191, 0, 0}, {0, 0, 191}}},
            reverse{{{0, 0, 191}, {0, 0, 0}, {191, 0, 191}, {0, 0, 0}, {0, 191, 191}, {0, 0, 0}, {191, 191, 191}}},
            full{{{255, 255, 255}, {0, 0, 0}, {255, 0, 0}, {0, 255, 0}, {0, 0, 255}, {0, 0, 0}, {10, 10, 10}}};
        for (std::size_t i = 0; i < 7; ++i) {
            const double x = (double(i) + 0.5) / 7;
            for (const double y : {0.0, 0.3, 0.65}) EXPECT_EQ(at(x, y), bars[i]) << i;
            EXPECT_EQ(at(x, 0.71), reverse[i]) << i;
            for (const double y : {0.78, 0.99}) EXPECT_EQ(at(x, y), full[i]) << i;
        }
        EXPECT_EQ(at(18.5 / 21, 0.9), (Rgba8{5, 5, 5}));
        EXPECT_EQ(at(20.5 / 21, 0.9), (Rgba8{15, 15, 15}));
    }
}

TEST(ColourCard, has_ramps_of_known_values) {
    for (const glm::ivec2 size : {glm::ivec2(64, 36), glm::ivec2(640, 360), glm::ivec2(1920, 1080), glm::ivec2(3840, 2160)}) {
        const RgbaImage card = drawColourCard(TestPicture::Ramp, size);
        for (const Rgba8 pixel : card.pixels()) ASSERT_TRUE(pixel.a == 255 && pixel.r == pixel.g && pixel.g == pixel.b);
        const auto row = [&](double y) {
            std::vector<int> values;  // without repetitions
            for (int x = 0; x < size.x; ++x)
                if (const int value = lightOf(card, x, int(y * size.y)); values.empty() || values.back() != value)
                    values.push_back(value);
            return values;
        };
        std::vector<int> steps, all, dark, light;
        for (int i = 0; i <= 16; ++i) steps.push_back(int(std::lround(255 * i / 16.0)));
        for (int i = 0; i < 256; ++i) all.push_back(i);
        for (int i = 0; i <= 32; ++i) dark.push_back(i), light.push_back(223 + i);
        EXPECT_EQ(row(0.01), steps);
        EXPECT_EQ(row(0.4) == all, size.x >= 256);
        EXPECT_EQ(row(0.52), dark);
        EXPECT_EQ(row(0.77), light);
        // The steps are labelled with their values where there is room.
        EXPECT_EQ(row(0.22) == steps && row(0.2) == steps && row(0.21) == steps && row(0.23) == steps, size.y < 360);
        EXPECT_EQ(card, drawColourCard(TestPicture::Ramp, size));
    }
}

}  // namespace
}  // namespace fantascope::plot
