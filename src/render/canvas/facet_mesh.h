#pragma once

#include "media/mesh.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <vector>

namespace fantascope::render {

// A vertex whose normal is that of a whole facet.
struct FacetVertex {
    glm::vec3 position{0};
    // Unit normal of the facet whose last corner this is. Zero: that facet is not shaded, or there
    // is no such facet.
    glm::vec3 normal{0};
};

// A mesh in which every triangle is the only one with its last corner. That corner carries the
// facet's data (OpenGL's provoking vertex), and the other corners are shared. It has about as many
// vertices as triangles; separate facets would need three times as many.
struct FacetMesh {
    std::vector<FacetVertex> vertices;
    std::vector<std::uint32_t> indices;  // three for each triangle
    bool closed = false;                 // the surface is closed, so back faces are never seen
};

// The same surface with no edge longer than `longest`: longer edges are halved, in both their
// triangles, until none is left.
TriangleMesh cutUp(TriangleMesh mesh, double longest);

// The same triangles with their facets' normals. Those of a flat mesh (all facets parallel) are
// zero, since a flat shape is not shaded.
FacetMesh facetMesh(const TriangleMesh& mesh);

}  // namespace fantascope::render
