#pragma once

#include "media/mesh.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <unordered_map>
#include <vector>

namespace fantascope::theatre {

// The planes of a grid along x, y and z, ascending; they may stand closer where a form is finer.
using GridPlanes = std::array<std::vector<double>, 3>;

// A closed surface, made cell by cell of a grid: marching tetrahedra, six to a cell, all around the
// same diagonal, so that cells agree on the faces between them. Each triangle lies in its
// tetrahedron, so that none runs into another.
class TetrahedraSurface {
public:
    // A cell's corners are numbered by their bits: 1 is a step along x, 2 along y, 4 along z.
    // `nodes`: the grid's own numbers of them; `values`: of the field, negative inside.
    void addCell(const std::array<std::size_t, 8>& nodes, const std::array<glm::dvec3, 8>& places,
                 const std::array<double, 8>& values);

    TriangleMesh mesh;

private:
    std::unordered_map<std::size_t, std::uint32_t> crossings_;  // the vertex of each edge that the surface crosses
};

// The surface where a field is 0, its inside where the field is negative: closed, each edge between
// two triangles, as long as the field is positive on the grid's outermost planes. `field` tells how
// far the surface is, up to a factor of `slack`: farther off it is not looked at closely.
TriangleMesh implicitSurface(const std::function<double(const glm::dvec3&)>& field, const GridPlanes& planes, double slack);

}  // namespace fantascope::theatre
