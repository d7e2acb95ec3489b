#include "theatre/body/simplify.h"

#include "theatre/body/body_mesh.h"
#include "theatre/body/implicit_surface.h"

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

namespace fantascope::theatre {
namespace {

using glm::dvec3;

TriangleMesh surfaceOf(const std::function<double(const dvec3&)>& field, int cells) {
    GridPlanes planes;
    for (auto& axis : planes)
        for (int i = 0; i <= cells; ++i) axis.push_back(2.0 * i / cells - 1);
    return implicitSurface(field, planes, 1.8);
}
double evenly(const glm::vec3&) { return 1; }
int eulerOf(const TriangleMesh& mesh) {
    const auto edges = edgesOf(mesh);
    EXPECT_FALSE(edges.empty()) << "it is not closed";
    return static_cast<int>(mesh.vertices.size()) - static_cast<int>(edges.size()) + static_cast<int>(mesh.triangles.size());
}

TEST(Simplified, keeps_a_ball_a_ball) {
    const TriangleMesh fine = surfaceOf([](const dvec3& p) { return glm::length(p) - 0.8; }, 40);
    ASSERT_GT(fine.triangles.size(), 10000u);
    const TriangleMesh coarse = simplified(fine, 500, evenly);
    EXPECT_LE(coarse.triangles.size(), 500u);
    EXPECT_GE(coarse.triangles.size(), 498u);
    EXPECT_EQ(eulerOf(coarse), 2);
    for (const glm::vec3& v : coarse.vertices) EXPECT_NEAR(glm::length(v), 0.8, 0.015);
    for (const glm::uvec3& t : coarse.triangles) {
        const dvec3 a = coarse.vertices[t.x], b = coarse.vertices[t.y], c = coarse.vertices[t.z];
        EXPECT_GT(glm::dot(glm::cross(b - a, c - a), a + b + c), 0) << "a triangle is turned over";
    }
}

TEST(Simplified, keeps_the_hole_of_a_ring_however_few_are_asked_for) {
    const TriangleMesh fine = surfaceOf([](const dvec3& p) { return std::hypot(std::hypot(p.x, p.y) - 0.6, p.z) - 0.2; }, 30);
    for (const std::size_t count : {1000u, 100u, 0u}) EXPECT_EQ(eulerOf(simplified(fine, count, evenly)), 0) << count;
}

// A box needs few triangles for its sides: its corners stay where they are.
TEST(Simplified, keeps_the_corners_of_a_box) {
    const TriangleMesh fine = surfaceOf(
        [](const dvec3& p) {
            return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) - 0.61;
        },
        32);
    const TriangleMesh coarse = simplified(fine, 200, evenly);
    const auto nearest = [](const TriangleMesh& mesh, const dvec3& corner) {
        double nearest = 9;
        for (const glm::vec3& v : mesh.vertices) nearest = std::min(nearest, glm::distance(dvec3(v), corner));
        return nearest;
    };
    for (const double x : {-0.61, 0.61})
        for (const double y : {-0.61, 0.61})
            for (const double z : {-0.61, 0.61}) EXPECT_LT(nearest(coarse, {x, y, z}), nearest(fine, {x, y, z}) + 0.01);
}

TEST(Simplified, is_the_same_bytes_each_time) {
    const auto make = [] { return simplified(surfaceOf([](const dvec3& p) { return glm::length(p) - 0.8; }, 24), 300, evenly); };
    const TriangleMesh first = make(), second = make();
    EXPECT_EQ(first.vertices, second.vertices);
    EXPECT_EQ(first.triangles, second.triangles);
}

TEST(Simplified, keeps_more_of_what_matters_more) {
    const TriangleMesh fine = surfaceOf([](const dvec3& p) { return glm::length(p) - 0.8; }, 30);
    const TriangleMesh coarse = simplified(fine, 600, [](const glm::vec3& p) { return p.x > 0 ? 20.0 : 1.0; });
    const auto right = std::count_if(coarse.vertices.begin(), coarse.vertices.end(), [](const glm::vec3& v) { return v.x > 0; });
    EXPECT_GT(right, static_cast<std::ptrdiff_t>(coarse.vertices.size()) * 3 / 5);
}

}  // namespace
}  // namespace fantascope::theatre
