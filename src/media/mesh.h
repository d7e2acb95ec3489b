#pragma once

#include "core/result.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <filesystem>
#include <vector>

namespace fantascope {

// Triangles in space, right-handed, y up; each triangle's corners run anticlockwise as seen from
// outside.
struct TriangleMesh {
    std::vector<glm::vec3> vertices;
    std::vector<glm::uvec3> triangles;  // indices into vertices
};

// Reads all triangle meshes of an FBX, OBJ, glTF, PLY or STL file as one. Node transforms are
// applied; units are the file's own. If the file declares its axes (FBX), the mesh is turned y up,
// facing +z. Polygons are triangulated, equal vertices joined, triangles without area dropped.
// Error: names the file: missing, not a mesh, no triangle left, or a coordinate that is not finite.
Result<TriangleMesh> readMesh(const std::filesystem::path& path);

// Writes a Wavefront OBJ; coordinates read back exactly. Error: names the file and why it cannot be
// written.
Result<void> writeObj(const std::filesystem::path& path, const TriangleMesh& mesh);

}  // namespace fantascope
