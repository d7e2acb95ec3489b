#pragma once

#include "core/result.h"
#include "media/mesh.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace fantascope {

// What somebody who prints a mesh asks of it; found by CGAL, exactly, for the coordinates as they
// are.
struct SolidCheck {
    bool isManifold = false;    // around every edge lie two triangles that agree on the outside, around every vertex one fan
    bool isClosed = false;      // every edge has two
    bool facesOutward = false;  // the triangles' corners run anticlockwise as seen from outside
    std::size_t pieces = 0;     // that do not hang together
    double volume = 0;          // in cubes of the mesh's unit
    std::vector<std::uint32_t> crossings;  // triangles that run through another, or have no area

    bool isSound() const { return isManifold && isClosed && facesOutward && crossings.empty(); }
};
SolidCheck checkSolid(const TriangleMesh& mesh);

// Of triangles 0, `every`, twice that and so on: how far it is from its middle straight inwards to
// the other side, in the mesh's unit: the thickness of what it bounds; infinite where nothing is
// met.
std::vector<double> thicknesses(const TriangleMesh& mesh, std::size_t every);

// A binary STL, in the mesh's own units and axes. Equal vertices come back equal. Error: names the
// file and why it cannot be written.
Result<void> writeStl(const std::filesystem::path& path, const TriangleMesh& mesh);

}  // namespace fantascope
