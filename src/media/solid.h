#pragma once

#include "core/result.h"
#include "media/mesh.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace fantascope {

// A check whether a mesh can be printed. CGAL computes it exactly for the given coordinates.
struct SolidCheck {
    bool isManifold = false;               // two triangles at every edge, which agree on the outside; one fan at every vertex
    bool isClosed = false;                 // two triangles at every edge
    bool facesOutward = false;             // the triangles' corners run anticlockwise as seen from outside
    std::size_t pieces = 0;                // unconnected ones
    double volume = 0;                     // in cubes of the mesh's unit
    std::vector<std::uint32_t> crossings;  // triangles that intersect another, or have no area

    bool isSound() const { return isManifold && isClosed && facesOutward && crossings.empty(); }
};
SolidCheck checkSolid(const TriangleMesh& mesh);

// The wall's thickness at triangles 0, `every`, 2 `every` and so on: the distance from the
// triangle's centre straight inwards to the other side, in the mesh's unit; infinite if nothing is
// hit.
std::vector<double> thicknesses(const TriangleMesh& mesh, std::size_t every);

// Writes a binary STL, in the mesh's own units and axes. Equal vertices stay equal. Error: names
// the file and why it cannot be written.
Result<void> writeStl(const std::filesystem::path& path, const TriangleMesh& mesh);

}  // namespace fantascope
