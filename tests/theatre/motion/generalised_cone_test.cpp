#include "theatre/motion/generalised_cone.h"

#include "theatre/stage/stage.h"

#include "core/random.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace fantascope::theatre {
namespace {

const glm::dvec3 kLight{0.3, 0.1, 7};
// A square of two triangles and one more beside it.
const std::vector<glm::uvec3> kTriangles{{0, 1, 2}, {0, 2, 3}, {1, 4, 2}};
const std::vector<glm::dvec2> kCorners{{-1, 0}, {0.5, 0}, {0.5, 1.5}, {-1, 1.5}, {1.4, 0.8}};

glm::dvec2 shadowOf(const glm::dvec3& point) {
    return glm::dvec2(kLight) + kLight.z / (kLight.z - point.z) * glm::dvec2(point - kLight);
}
// The point whose shadow falls at a place, a share of the way from the light to the screen.
glm::dvec3 before(glm::dvec2 shadow, double share) { return kLight + share * (glm::dvec3(shadow, 0) - kLight); }

TEST(GeneralisedCone, has_every_point_at_its_coordinates) {
    const GeneralisedCone cone(kLight, kTriangles, kCorners);
    Rng rng(1);
    for (int i = 0; i < 200; ++i) {
        const glm::dvec3 point = before({rng.uniform(-3, 3), rng.uniform(-1, 3)}, rng.uniform(0.2, 0.99));
        const auto coordinates = cone.coordinates(point);
        const glm::dvec4& w = coordinates.weights;
        EXPECT_NEAR(w.x + w.y + w.z + w.w, 1, 1e-12);
        EXPECT_GE(std::min({w.x, w.y, w.z, w.w}), -1e-12);
        EXPECT_LT(glm::distance(cone.point(coordinates), point), 1e-12);
    }
}

TEST(GeneralisedCone, carries_what_stands_in_a_tetrahedron_as_its_corners_go) {
    const GeneralisedCone cone(kLight, kTriangles, kCorners);
    std::vector<glm::dvec2> moved = kCorners;
    moved[1] += glm::dvec2(0.2, -0.1);
    moved[2] += glm::dvec2(-0.3, 0.4);
    const GeneralisedCone other(kLight, kTriangles, moved);
    const glm::dvec2 inFirst = (kCorners[0] + 2.0 * kCorners[1] + kCorners[2]) / 4.0;
    const auto coordinates = cone.coordinates(before(inFirst, 0.6));
    EXPECT_EQ(coordinates.tetrahedron, 0u);
    const glm::dvec3 there = other.point(coordinates);
    EXPECT_LT(glm::distance(shadowOf(there), (moved[0] + 2.0 * moved[1] + moved[2]) / 4.0), 1e-12);
    EXPECT_NEAR(there.z, 0.4 * kLight.z, 1e-12) << "no nearer to the light";
}

// Beside the triangle it goes along, and turns with it, however the triangle is stretched.
TEST(GeneralisedCone, takes_along_what_stands_beside) {
    const GeneralisedCone cone(kLight, kTriangles, kCorners);
    const glm::dvec2 below(-0.25, -0.4);  // of the first edge, which is level
    const auto coordinates = cone.coordinates(before(below, 0.5));
    std::vector<glm::dvec2> turned = kCorners;  // about the first corner by a right angle, and twice as far
    for (glm::dvec2& corner : turned) {
        const glm::dvec2 from = corner - kCorners[0];
        corner = kCorners[0] + 2.0 * glm::dvec2(-from.y, from.x);
    }
    const glm::dvec2 foot = kCorners[0] + glm::dvec2(0, 2 * 0.75);
    const glm::dvec3 there = GeneralisedCone(kLight, kTriangles, turned).point(coordinates);
    EXPECT_LT(glm::distance(shadowOf(there), foot + glm::dvec2(0.4, 0)), 1e-12);
}

TEST(GeneralisedCone, stands_a_triangle_without_area) {
    const std::vector<glm::dvec2> flat{{0, 0}, {1, 0}, {2, 0}, {0, 0}, {0, 0}};
    const GeneralisedCone cone(kLight, kTriangles, flat);
    const glm::dvec3 point = before({1.5, 0.5}, 0.7);
    EXPECT_LT(glm::distance(cone.point(cone.coordinates(point)), point), 1e-12);
}

}  // namespace
}  // namespace fantascope::theatre
