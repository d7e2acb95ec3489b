#include "core/outline.h"

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

namespace fantascope {
namespace {

using testing::IsEmpty;

using Ring = std::vector<glm::dvec2>;

// Half the cross product of two sides of each: negative where corners run clockwise.
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

// Example failure: the direction of a ring decides whether it is a hole, and a drawing program's own order fills it.
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

// A polygon of n corners and h holes has n + 2h - 2 triangles, the fewest possible: none is added inside.
TEST(Outline, no_triangle_is_spent_on_points_of_its_own) {
    EXPECT_EQ(filled({{circle(1, 17)}}).triangles.size(), 15u);
    EXPECT_EQ(filled({{circle(1, 17), circle(0.5, 5)}}).triangles.size(), 22u);
}

// A stroke one pixel wide is traced there and back along the same line. Example failure: whoever counts that line as one border
// takes the outside beyond it for the inside.
TEST(Outline, a_line_there_and_back_has_no_area_and_turns_nothing_inside_out) {
    const Ring flag = {{-1, -1}, {1, -1}, {1, 0}, {5, 0}, {5, 3}, {5, 0}, {1, 0}, {1, 1}, {-1, 1}};
    EXPECT_NEAR(area(filled({{flag}})), 4, 1e-6);
    EXPECT_THAT(filled({{{{0, 0}, {1, 1}}}}).triangles, IsEmpty());
    EXPECT_THAT(filled({{{{0, 0}, {1, 1}, {2, 2}}}}).triangles, IsEmpty());
    EXPECT_THAT(filled({}).triangles, IsEmpty());
}

// The bow: two triangles that meet in the middle.
TEST(Outline, rings_that_cross_themselves_are_cut_there) {
    EXPECT_NEAR(area(filled({{{{-1, -1}, {1, 1}, {1, -1}, {-1, 1}}}})), 2, 1e-6);
}

TEST(Outline, is_simplified_within_its_tolerance) {
    const Outline round{{circle(1, 2000)}};
    const Outline simple = simplified(round, 0.01, 1000);
    EXPECT_LE(simple.pointCount(), 46u);  // the fewest, evenly placed, would be 23
    EXPECT_GE(simple.pointCount(), 23u);
    const auto& ring = simple.rings.at(0);
    for (std::size_t i = 0; i < ring.size(); ++i)  // a chord lies farthest from the circle in its middle
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

// Example failure: the tolerance has the last word, and a gear of a thousand teeth keeps them all.
TEST(Outline, the_most_points_are_never_more) {
    Ring gear = circle(1, 2000);
    for (std::size_t i = 0; i < gear.size(); i += 2) gear[i] *= 1.2;
    for (const std::size_t most : {100u, 20u, 3u})
        EXPECT_LE(simplified({{gear, circle(0.5, 100)}}, 0.001, most).pointCount(), most);
    EXPECT_NEAR(area(filled(simplified({{gear}}, 0.001, 100))), std::numbers::pi * 1.21, 0.4);
}

}  // namespace
}  // namespace fantascope
