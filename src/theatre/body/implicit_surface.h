#pragma once

#include "media/mesh.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <unordered_map>
#include <vector>

namespace fantascope::theatre {

// The planes of a grid along x, y and z, ascending. The spacing may vary.
using GridPlanes = std::array<std::vector<double>, 3>;

// A closed surface, built cell by cell on a grid by marching tetrahedra. Each cell has six
// tetrahedra around the same diagonal, so that adjacent cells agree on the face between them. Each
// triangle lies in its own tetrahedron, so triangles do not intersect.
class TetrahedraSurface {
public:
    // A cell's corners are numbered by their bits: 1 is a step along x, 2 along y, 4 along z.
    // `nodes`: the corners' numbers in the grid. `values`: the field at the corners, negative
    // inside.
    void addCell(const std::array<std::size_t, 8>& nodes, const std::array<glm::dvec3, 8>& places,
                 const std::array<double, 8>& values);

    TriangleMesh mesh;

private:
    std::unordered_map<std::size_t, std::uint32_t> crossings_;  // the vertex of each edge that the surface crosses
};

// The surface where a field is 0; inside, the field is negative. The surface is closed, with two
// triangles at each edge, if the field is positive on the grid's outermost planes. The magnitude of
// `field` is at most `slack` times the distance to the surface; blocks of cells that are certainly
// too far away are skipped.
TriangleMesh implicitSurface(const std::function<double(const glm::dvec3&)>& field, const GridPlanes& planes, double slack);

}  // namespace fantascope::theatre
