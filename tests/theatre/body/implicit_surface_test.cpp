#include "theatre/body/implicit_surface.h"

#include "theatre/body/body_mesh.h"

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

namespace fantascope::theatre {
namespace {

using glm::dvec3;

GridPlanes cube(double half, int cells) {
    GridPlanes planes;
    for (auto& axis : planes)
        for (int i = 0; i <= cells; ++i) axis.push_back(half * (2.0 * i / cells - 1));
    return planes;
}
double volumeOf(const TriangleMesh& mesh) {
    double volume = 0;
    for (const glm::uvec3& t : mesh.triangles)
        volume += glm::dot(dvec3(mesh.vertices[t.x]), glm::cross(dvec3(mesh.vertices[t.y]), dvec3(mesh.vertices[t.z]))) / 6;
    return volume;
}
int eulerOf(const TriangleMesh& mesh) {
    const auto edges = edgesOf(mesh);
    EXPECT_FALSE(edges.empty()) << "it is not closed";
    return static_cast<int>(mesh.vertices.size()) - static_cast<int>(edges.size()) + static_cast<int>(mesh.triangles.size());
}

TEST(ImplicitSurface, of_a_ball_lies_on_it_and_looks_outward) {
    const auto ball = [](const dvec3& p) { return glm::length(p) - 0.8; };
    GridPlanes planes = cube(1, 30);
    // Planes may stand unevenly.
    planes[0].insert(planes[0].begin() + 20, 0.5 * (planes[0][19] + planes[0][20]));
    const TriangleMesh mesh = implicitSurface(ball, planes, 1.1);
    EXPECT_EQ(eulerOf(mesh), 2);
    for (const glm::vec3& v : mesh.vertices) EXPECT_NEAR(glm::length(v), 0.8, 0.004);
    const double whole = 4 * std::numbers::pi / 3 * 0.512;
    EXPECT_NEAR(volumeOf(mesh), whole, 0.01 * whole);
}

TEST(ImplicitSurface, of_a_ring_has_its_hole) {
    const auto ring = [](const dvec3& p) { return std::hypot(std::hypot(p.x, p.y) - 0.6, p.z) - 0.2; };
    EXPECT_EQ(eulerOf(implicitSurface(ring, cube(1, 33), 1.1)), 0);
}

// Corners that lie on the surface itself, thin walls, two pieces that touch in an edge of the grid:
// still closed.
TEST(ImplicitSurface, is_closed_whatever_the_field) {
    const auto onTheGrid = [](const dvec3& p) { return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) - 0.5; };
    EXPECT_EQ(eulerOf(implicitSurface(onTheGrid, cube(1, 8), 2)), 2);
    const auto rough = [](const dvec3& p) {
        return std::max(glm::length(p) - 0.9, std::sin(37 * p.x) + std::sin(41 * p.y + 1) + std::sin(43 * p.z + 2));
    };
    EXPECT_FALSE(edgesOf(implicitSurface(rough, cube(1, 24), 1e9)).empty());
}

// Far from the surface the field is not asked for.
TEST(ImplicitSurface, looks_closely_only_near_the_surface) {
    int asked = 0;
    const auto ball = [&](const dvec3& p) { return ++asked, glm::length(p) - 0.8; };
    const auto mesh = implicitSurface(ball, cube(1, 80), 1.1);
    EXPECT_LT(asked, 81 * 81 * 81 / 3);
    EXPECT_EQ(mesh.triangles.size(), implicitSurface(ball, cube(1, 80), 1e9).triangles.size());
}

}  // namespace
}  // namespace fantascope::theatre
