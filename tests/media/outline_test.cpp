#include "media/outline.h"

#include "core/random.h"
#include "pictures.h"

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace fantascope {
namespace {

using testing::IsEmpty;

using Ring = std::vector<glm::dvec2>;

// Half the cross product of two sides of each triangle: negative if corners run clockwise.
double area(const TriangleMesh& mesh) {
    double sum = 0;
    for (const glm::uvec3 t : mesh.triangles) {
        const glm::dvec3 a = mesh.vertices[t.x], b = mesh.vertices[t.y], c = mesh.vertices[t.z];
        EXPECT_GT(glm::cross(b - a, c - a).z, 0) << "does not face the viewer";
        sum += glm::cross(b - a, c - a).z / 2;
    }
    return sum;
}

Ring square(double half) { return {{-half, -half}, {half, -half}, {half, half}, {-half, half}}; }
Ring clockwise(Ring ring) { return {ring.rbegin(), ring.rend()}; }
Ring circle(double radius, int points) {
    Ring ring;
    for (int i = 0; i < points; ++i) {
        const double angle = 2 * std::numbers::pi * i / points;
        ring.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
    }
    return ring;
}

// Example failure: the direction of a ring decides whether it is a hole, and some drawing programs
// fill holes.
TEST(Outline, a_ring_inside_a_ring_is_a_hole_whatever_its_direction) {
    for (const Ring& hole : {square(1), clockwise(square(1))}) {
        EXPECT_NEAR(area(filled({{square(2), hole}})), 16 - 4, 1e-6);
        EXPECT_NEAR(area(filled({{square(2), hole, square(0.5)}})), 16 - 4 + 1, 1e-6) << "an island in the hole";
    }
}

TEST(Outline, parts_that_lie_apart_are_all_filled) {
    Ring far = square(1);
    for (glm::dvec2& point : far) point.x += 10;
    const TriangleMesh mesh = filled({{square(1), far}});
    EXPECT_NEAR(area(mesh), 8, 1e-6);
    EXPECT_EQ(mesh.triangles.size(), 4u);
}

// A polygon of n corners and h holes has n + 2h - 2 triangles, the minimum: no points are added
// inside.
TEST(Outline, no_triangle_is_spent_on_points_of_its_own) {
    EXPECT_EQ(filled({{circle(1, 17)}}).triangles.size(), 15u);
    EXPECT_EQ(filled({{circle(1, 17), circle(0.5, 5)}}).triangles.size(), 22u);
}

// A stroke one pixel wide is traced there and back along the same line. Example failure: that line
// counts as one border, and the outside beyond it as inside.
TEST(Outline, a_line_there_and_back_has_no_area_and_turns_nothing_inside_out) {
    const Ring flag = {{-1, -1}, {1, -1}, {1, 0}, {5, 0}, {5, 3}, {5, 0}, {1, 0}, {1, 1}, {-1, 1}};
    EXPECT_NEAR(area(filled({{flag}})), 4, 1e-6);
    EXPECT_THAT(filled({{{{0, 0}, {1, 1}}}}).triangles, IsEmpty());
    EXPECT_THAT(filled({{{{0, 0}, {1, 1}, {2, 2}}}}).triangles, IsEmpty());
    EXPECT_THAT(filled({}).triangles, IsEmpty());
}

// A bow tie: two triangles that meet in the middle.
TEST(Outline, rings_that_cross_themselves_are_cut_there) {
    EXPECT_NEAR(area(filled({{{{-1, -1}, {1, 1}, {1, -1}, {-1, 1}}}})), 2, 1e-6);
}

TEST(Outline, is_simplified_within_its_tolerance) {
    const Outline round{{circle(1, 2000)}};
    const Outline simple = simplified(round, 0.01, 1000);
    EXPECT_LE(simple.pointCount(), 46u);  // 23 evenly placed points would be the minimum
    EXPECT_GE(simple.pointCount(), 23u);
    const auto& ring = simple.rings.at(0);
    for (std::size_t i = 0; i < ring.size(); ++i)  // a chord is farthest from the circle in its middle
        EXPECT_LT(1 - glm::length((ring[i] + ring[(i + 1) % ring.size()]) / 2.0), 0.01 + 1e-9);
}

TEST(Outline, corners_are_kept_and_points_on_straight_sides_go) {
    Ring dense;
    const Ring corners = square(1);
    for (std::size_t i = 0; i < 4; ++i)
        for (int k = 0; k < 50; ++k) dense.push_back(glm::mix(corners[i], corners[(i + 1) % 4], k / 50.0));
    const Outline simple = simplified({{dense}}, 0.001, 1000);
    EXPECT_THAT(simple.rings.at(0), testing::UnorderedElementsAreArray(corners));
}

// Example failure: the tolerance takes precedence, and a gear with a thousand teeth keeps them all.
TEST(Outline, the_most_points_are_never_more) {
    Ring gear = circle(1, 2000);
    for (std::size_t i = 0; i < gear.size(); i += 2) gear[i] *= 1.2;
    for (const std::size_t most : {100u, 20u, 3u})
        EXPECT_LE(simplified({{gear, circle(0.5, 100)}}, 0.001, most).pointCount(), most);
    EXPECT_NEAR(area(filled(simplified({{gear}}, 0.001, 100))), std::numbers::pi * 1.21, 0.4);
}

double areaOf(const Ring& ring) {
    double sum = 0;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const glm::dvec2 a = ring[i], b = ring[(i + 1) % ring.size()];
        sum += (a.x * b.y - a.y * b.x) / 2;
    }
    return sum;
}

// Example failure: the hole is meshed too, or the island in it is forgotten.
TEST(Meshed, fills_the_region_with_triangles_of_one_size_that_are_no_slivers) {
    const Outline outline{{circle(4, 60), clockwise(circle(2, 30)), circle(1, 20)}};
    constexpr double kLongest = 0.5;
    const FlatMesh mesh = meshed(outline, kLongest);
    double sum = 0;
    for (const glm::uvec3 t : mesh.triangles) {
        const std::array<glm::dvec2, 3> corners = {mesh.vertices[t.x], mesh.vertices[t.y], mesh.vertices[t.z]};
        const double twice = 2 * areaOf({corners.begin(), corners.end()});
        EXPECT_GT(twice, 0);
        sum += twice / 2;
        for (std::size_t i = 0; i < 3; ++i) {
            const glm::dvec2 a = corners[(i + 1) % 3] - corners[i], b = corners[(i + 2) % 3] - corners[i];
            EXPECT_LE(glm::length(a), kLongest);
            EXPECT_GT(std::asin(twice / glm::length(a) / glm::length(b)) * 180 / std::numbers::pi, 20);
        }
    }
    EXPECT_NEAR(sum, areaOf(circle(4, 60)) - areaOf(circle(2, 30)) + areaOf(circle(1, 20)), 1e-9);
}

// White pixels end half-way to their black neighbours, and at the picture's edge; only their
// corners are cut off.
TEST(Borders, run_between_white_and_black_around_islands_and_the_other_way_around_holes) {
    const GreyImage picture = pictureOf(
        30, 20, [](int x, int y) { return (isIn(x, y, 0, 0, 12, 10) && !isIn(x, y, 4, 3, 4, 4)) || isIn(x, y, 20, 10, 10, 10); });
    const Outline borders = tracedBorders(picture);
    constexpr double kCutOff = 4 * 0.125;
    ASSERT_EQ(borders.rings.size(), 3u);
    std::vector<double> areas;
    for (const Ring& ring : borders.rings) areas.push_back(areaOf(ring));
    std::sort(areas.begin(), areas.end());
    EXPECT_NEAR(areas[0], -(16 - kCutOff), 1e-9);
    // At the picture's edge the light ends with the pixel, half a pixel beyond its centre.
    EXPECT_NEAR(areas[1], 100 - kCutOff, 1e-9);
    EXPECT_NEAR(areas[2], 120 - kCutOff, 1e-9);
}

// Example failure: where two pixels touch at a corner, the tracer takes the wrong way and never
// returns.
TEST(Borders, are_closed_and_never_meet_in_a_picture_of_noise) {
    Rng rng(1);
    const GreyImage noise = pictureOf(60, 40, [&](int, int) { return rng.uniform() < 0.5; });
    const Outline borders = tracedBorders(noise);
    std::vector<std::pair<double, double>> points;
    for (const Ring& ring : borders.rings) {
        for (std::size_t i = 0; i < ring.size(); ++i) {
            EXPECT_LE(glm::distance(ring[i], ring[(i + 1) % ring.size()]), 1.0 + 1e-9) << "no step leaves its square";
            points.emplace_back(ring[i].x, ring[i].y);
        }
    }
    std::sort(points.begin(), points.end());
    EXPECT_EQ(std::adjacent_find(points.begin(), points.end()), points.end());
    // Drawing the borders gives the picture again, except for the cut corners of an isolated pixel,
    // half of it.
    const GreyImage again = drawn(borders, 60, 40);
    for (int y = 0; y < 40; ++y)
        for (int x = 0; x < 60; ++x) ASSERT_NEAR(again.at(x, y), noise.at(x, y), 0.5 + 1e-6) << x << ' ' << y;
}

TEST(Borders, of_greys_lie_where_the_light_passes_a_half) {
    const GreyImage picture = [] {
        GreyImage ramp(9, 5);
        for (int y = 0; y < 5; ++y)
            for (int x = 0; x < 9; ++x) ramp.at(x, y) = std::max(0.0f, 1 - 0.2f * static_cast<float>(x));
        return ramp;
    }();
    const Outline borders = tracedBorders(picture);
    ASSERT_EQ(borders.rings.size(), 1u);
    for (const glm::dvec2 point : borders.rings[0])
        EXPECT_TRUE(point.y < 1 || point.y > 4 || point.x < 1 || std::abs(point.x - 3) < 1e-6) << "0.6 at 2.5, 0.4 at 3.5";
    EXPECT_THAT(tracedBorders(GreyImage(5, 5)).rings, IsEmpty());
}

// Two diagonal light pixels are connected if the middle is no darker than a half.
TEST(Borders, join_what_meets_in_a_corner_unless_it_is_dark_there) {
    const auto rings = [](float light, float dark) {
        GreyImage picture(4, 4, 0);
        picture.at(1, 1) = picture.at(2, 2) = light;
        picture.at(2, 1) = picture.at(1, 2) = dark;
        return tracedBorders(picture).rings.size();
    };
    EXPECT_EQ(rings(1, 0), 1u);
    EXPECT_EQ(rings(0.6f, 0.45f), 1u);
    EXPECT_EQ(rings(0.6f, 0.2f), 2u);
}

TEST(Drawn, is_how_much_of_a_pixel_is_covered) {
    const GreyImage picture = drawn({{{{1.25, 1}, {3.5, 1}, {3.5, 2.5}, {1.25, 2.5}}}}, 5, 4);
    const std::vector<std::vector<float>> wanted = {
        {0, 0, 0, 0, 0}, {0, 0.75f, 1, 0.5f, 0}, {0, 0.375f, 0.5f, 0.25f, 0}, {0, 0, 0, 0, 0}};
    for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 5; ++x) EXPECT_NEAR(picture.at(x, y), wanted[std::size_t(y)][std::size_t(x)], 1e-6) << x << ' ' << y;
}

// An ear that is bent over the head. Example failure: overlaps cancel out.
TEST(Drawn, what_overlaps_stays_filled_and_holes_stay_open) {
    const Ring big = {{0, 0}, {6, 0}, {6, 6}, {0, 6}}, other = {{4, 4}, {9, 4}, {9, 9}, {4, 9}},
               hole = {{1, 1}, {1, 3}, {3, 3}, {3, 1}};
    const GreyImage picture = drawn({{big, other, hole}}, 10, 10);
    EXPECT_EQ(picture.at(5, 5), 1);
    EXPECT_EQ(picture.at(8, 8), 1);
    EXPECT_EQ(picture.at(2, 2), 0);
    EXPECT_EQ(picture.at(9, 0), 0);
    // A part that is moved over the hole closes it.
    EXPECT_EQ(drawn({{big, hole, {{0, 0}, {4, 0}, {4, 4}, {0, 4}}}}, 10, 10).at(2, 2), 1);
    // Parts outside the picture are cut off, and fill nothing else.
    const GreyImage cut = drawn({{{{-5, -5}, {2, -5}, {2, 20}, {-5, 20}}}}, 4, 4);
    EXPECT_EQ(cut.at(1, 3), 1);
    EXPECT_EQ(cut.at(2, 0), 0);
}

}  // namespace
}  // namespace fantascope
