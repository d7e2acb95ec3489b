#include "render/canvas/facet_mesh.h"

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <array>
#include <set>

namespace fantascope::render {
namespace {

const TriangleMesh kTetrahedron{{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}, {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}}};

std::array<glm::vec3, 3> cornersOf(const FacetMesh& facets, std::size_t triangle) {
    const auto at = [&](std::size_t corner) { return facets.vertices[facets.indices[3 * triangle + corner]].position; };
    return {at(0), at(1), at(2)};
}

// OpenGL takes a facet's normal from its last corner.
// Example failure: a corner that two facets share has the normal of the later one.
TEST(FacetMesh, each_facets_last_corner_is_its_own_and_has_its_normal) {
    const FacetMesh facets = facetMesh(kTetrahedron);
    ASSERT_EQ(facets.indices.size(), 12u);
    std::set<std::uint32_t> last;
    for (std::size_t t = 0; t < 4; ++t) {
        EXPECT_TRUE(last.insert(facets.indices[3 * t + 2]).second);
        const auto [a, b, c] = cornersOf(facets, t);
        const glm::vec3 normal = glm::normalize(glm::cross(b - a, c - a));
        EXPECT_LT(glm::distance(facets.vertices[facets.indices[3 * t + 2]].normal, normal), 1e-6f);
        EXPECT_GT(glm::dot(normal, a), 0) << "the triangle was flipped";
    }
}

TEST(FacetMesh, keeps_the_triangles_and_shares_their_other_corners) {
    const FacetMesh facets = facetMesh(kTetrahedron);
    EXPECT_LE(facets.vertices.size(), 5u) << "separate facets would need 12";
    for (std::size_t t = 0; t < 4; ++t) {
        const glm::uvec3 triangle = kTetrahedron.triangles[t];
        std::set<std::array<float, 3>> wanted, found;
        for (const std::uint32_t v : {triangle.x, triangle.y, triangle.z})
            wanted.insert({kTetrahedron.vertices[v].x, kTetrahedron.vertices[v].y, kTetrahedron.vertices[v].z});
        for (const glm::vec3 p : cornersOf(facets, t)) found.insert({p.x, p.y, p.z});
        EXPECT_EQ(found, wanted);
    }
}

// With more facets than corners, some corners must be copied.
TEST(FacetMesh, copies_a_corner_when_all_three_are_taken) {
    const TriangleMesh fan{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                           {{0, 1, 2}, {0, 2, 1}, {0, 1, 3}, {0, 3, 1}, {0, 2, 3}, {0, 3, 2}}};
    const FacetMesh facets = facetMesh(fan);
    EXPECT_EQ(facets.vertices.size(), 6u);
    std::set<std::uint32_t> last;
    for (std::size_t t = 0; t < 6; ++t) last.insert(facets.indices[3 * t + 2]);
    EXPECT_EQ(last.size(), 6u);
}

TEST(FacetMesh, a_flat_shape_has_no_normals_whichever_way_its_triangles_turn) {
    const FacetMesh facets = facetMesh({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 3, 2}}});
    for (const FacetVertex& vertex : facets.vertices) EXPECT_EQ(vertex.normal, glm::vec3(0));
}

// Back faces may be culled only on a closed surface.
TEST(FacetMesh, knows_closed_surfaces_from_open_and_inverted_ones) {
    EXPECT_TRUE(facetMesh(kTetrahedron).closed);
    TriangleMesh open = kTetrahedron;
    open.triangles.pop_back();
    EXPECT_FALSE(facetMesh(open).closed);
    TriangleMesh oneTurned = kTetrahedron;
    std::swap(oneTurned.triangles[0].x, oneTurned.triangles[0].y);
    EXPECT_FALSE(facetMesh(oneTurned).closed);
    TriangleMesh insideOut = kTetrahedron;
    for (glm::uvec3& triangle : insideOut.triangles) std::swap(triangle.x, triangle.y);
    EXPECT_FALSE(facetMesh(insideOut).closed);
}

}  // namespace
}  // namespace fantascope::render
