#include "plot/rendering.h"

#include <glm/common.hpp>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fantascope::plot {
namespace {

constexpr glm::vec3 kBlack(0), kRed(1, 0, 0), kBlue(0, 0, 1);

// An upright square with its middle and half its side.
TriangleMesh square(const glm::vec3& middle, float half) {
    return {{middle + glm::vec3(-half, -half, 0), middle + glm::vec3(half, -half, 0), middle + glm::vec3(half, half, 0),
             middle + glm::vec3(-half, half, 0)},
            {{0, 1, 2}, {0, 2, 3}}};
}

Surface plain(TriangleMesh mesh, const glm::vec3& colour, float opacity = 1) {
    return {std::move(mesh), [=](const glm::vec3&, const glm::vec3&) { return glm::vec4(colour, opacity); }, opacity < 1};
}

// At a height of 1 m, looking along -z. A metre at a distance of 5 m is 20 of 100 pixels.
const Camera kAhead{{0, 1, 5}, {0, 1, 0}, 2 * std::atan(0.5)};

TEST(Camera, puts_points_where_a_pinhole_does) {
    const glm::dvec2 ahead = kAhead.pixelAt({0, 1, 0}, 200, 100).value(), aside = kAhead.pixelAt({1, 1.5, 0}, 200, 100).value();
    EXPECT_NEAR(ahead.x, 100, 1e-9);
    EXPECT_NEAR(ahead.y, 50, 1e-9);
    EXPECT_NEAR(aside.x, 120, 1e-9);
    EXPECT_NEAR(aside.y, 40, 1e-9);
    EXPECT_NEAR(kAhead.pixelAt({1, 1, -5}, 200, 100)->x, 110, 1e-9) << "twice as far";
    EXPECT_FALSE(kAhead.pixelAt({0, 1, 6}, 200, 100));
}

TEST(Camera, fits_points_in_tightly) {
    const std::vector<glm::dvec3> points{{-1, 0, 0}, {2, 0, 0}, {0, 3, 1}, {0, 0, 7}, {-2, 1, 4}};
    for (const double aspect : {0.5, 1.0, 2.5}) {
        const Camera camera = Camera::fitting(points, {-0.7, -0.4, -0.6}, 0.6, aspect, 0.1);
        const int height = 1000, width = static_cast<int>(1000 * aspect);
        double most = 0;  // share of half the picture
        for (const glm::dvec3& point : points) {
            const glm::dvec2 off = camera.pixelAt(point, width, height).value() / glm::dvec2(0.5 * width, 0.5 * height) - 1.0;
            most = std::max({most, std::abs(off.x), std::abs(off.y)});
        }
        EXPECT_NEAR(most, 0.9, 1e-6) << aspect;
    }
}

TEST(Rendering, draws_a_square_where_its_corners_fall_and_nowhere_else) {
    const RgbaImage picture = rendered(std::vector{plain(square({1, 1, 0}, 0.5f), kRed)}, kAhead, kBlack, 200, 100);
    for (int y = 0; y < 100; ++y)
        for (int x = 0; x < 200; ++x) {
            const bool inside = x >= 110 && x < 130 && y >= 40 && y < 60;
            ASSERT_EQ(picture.at(x, y), (inside ? Rgba8{255, 0, 0} : Rgba8{0, 0, 0})) << x << ", " << y;
        }
}

TEST(Rendering, shows_the_nearer_before_the_farther_in_any_order) {
    const Surface near = plain(square({0, 1, 1}, 0.2f), kRed), far = plain(square({0, 1, 0}, 1), kBlue);
    for (const auto& surfaces : {std::vector{near, far}, std::vector{far, near}}) {
        const RgbaImage picture = rendered(surfaces, kAhead, kBlack, 200, 100);
        EXPECT_EQ(picture.at(100, 50), (Rgba8{255, 0, 0}));
        EXPECT_EQ(picture.at(110, 50), (Rgba8{0, 0, 255}));
    }
}

// Half of the light comes through, in any order of the surfaces. Nothing shows through an opaque
// surface.
TEST(Rendering, blends_what_is_translucent) {
    const Surface veil = plain(square({0, 1, 1}, 0.5f), kRed, 0.5f), wall = plain(square({0, 1, 0}, 1), kBlue);
    const auto half = static_cast<std::uint8_t>(std::lround(255 * srgbFromLinear(0.5f)));
    EXPECT_EQ(rendered(std::vector{veil, wall}, kAhead, kBlack, 200, 100).at(98, 47), (Rgba8{half, 0, half}));
    const Surface door = plain(square({0, 1, 2}, 0.5f), kBlue);
    EXPECT_EQ(rendered(std::vector{veil, door}, kAhead, kBlack, 200, 100).at(98, 47), (Rgba8{0, 0, 255}));
}

// Example failure: a floor that extends behind the camera is drawn inside out.
TEST(Rendering, cuts_what_reaches_behind_the_camera) {
    const Surface floor = plain({{{-50, 0, 50}, {50, 0, 50}, {50, 0, -500}, {-50, 0, -500}}, {{0, 1, 2}, {0, 2, 3}}}, kRed);
    const RgbaImage picture = rendered(std::vector{floor}, kAhead, kBlack, 200, 100);
    EXPECT_EQ(picture.at(100, 30), (Rgba8{0, 0, 0}));
    for (const int y : {60, 80, 99}) EXPECT_EQ(picture.at(100, y), (Rgba8{255, 0, 0})) << y;
}

TEST(Rendering, has_edges_between_its_pixels) {
    const RgbaImage picture = rendered(std::vector{plain(square({1.0f / 60, 1, 0}, 0.5f), kRed)}, kAhead, kBlack, 200, 100);
    const auto third = static_cast<std::uint8_t>(std::lround(255 * srgbFromLinear(1 / 3.0f)));
    EXPECT_EQ(picture.at(110, 50), (Rgba8{third, 0, 0}));
}

// A ridge of 90 degrees stays sharp, one of 20 degrees is smoothed.
TEST(Rendering, smooths_flat_edges_alone) {
    for (const double degrees : {10.0, 45.0}) {
        const auto deep = static_cast<float>(std::tan(degrees * std::numbers::pi / 180));
        const TriangleMesh ridge{{{-1, 0, -deep}, {0, 0, 0}, {1, 0, -deep}, {-1, 2, -deep}, {0, 2, 0}, {1, 2, -deep}},
                                 {{0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}}};
        float sideways = 0;
        const Surface surface{ridge, [&](const glm::vec3& place, const glm::vec3& normal) {
                                  if (std::abs(place.x) < 0.05f) sideways = std::max(sideways, std::abs(normal.x));
                                  return glm::vec4(1);
                              }};
        rendered(std::vector{surface}, kAhead, kBlack, 200, 100);
        const double flat = std::sin(degrees * std::numbers::pi / 180);
        if (degrees < 25)
            EXPECT_LT(sideways, 0.5 * flat);
        else
            EXPECT_NEAR(sideways, flat, 1e-4);
    }
}

}  // namespace
}  // namespace fantascope::plot
