#pragma once

#include "media/mesh.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <vector>

namespace fantascope::render {

// A vertex whose normal speaks for one whole facet.
struct FacetVertex {
    glm::vec3 position{0};
    glm::vec3 normal{
        0};  // unit, of the facet whose last corner this is; zero: the facet is not shaded, or it is nobody's last corner
};

// A mesh in which every triangle's last corner belongs to it alone, so that this corner can carry
// what holds for the whole facet (OpenGL's provoking vertex) while the other corners are shared:
// about as many vertices as triangles, where separate facets would need three times as many.
struct FacetMesh {
    std::vector<FacetVertex> vertices;
    std::vector<std::uint32_t> indices;  // three for each triangle
    bool closed = false;                 // the surface has an inside, so that facets turned away can never be seen
};

// The same surface with no edge longer than `longest`: long edges get a point in their middle, on
// both sides alike, until none is long.
TriangleMesh cutUp(TriangleMesh mesh, double longest);

// The same triangles with their facets' normals; those of a flat mesh (all facets parallel) are
// zero, since a paper shape has no facets to tell apart.
FacetMesh facetMesh(const TriangleMesh& mesh);

}  // namespace fantascope::render
