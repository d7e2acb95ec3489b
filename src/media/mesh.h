#pragma once

#include "core/result.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <filesystem>
#include <vector>

namespace fantascope {

// Triangles in space, right-handed, y up; each triangle's corners anticlockwise as seen from
// outside.
struct TriangleMesh {
    std::vector<glm::vec3> vertices;
    std::vector<glm::uvec3> triangles;  // indices into vertices
};

// All triangle meshes of an FBX, OBJ, glTF, PLY or STL file as one, node transforms applied, in the
// file's own units, turned y up and facing +z where the file says which of its axes those are
// (FBX); polygons are cut into triangles, equal vertices joined, triangles with no area dropped.
// Error: names the file: missing, not a mesh, no triangle left, or a coordinate that is not finite.
Result<TriangleMesh> readMesh(const std::filesystem::path& path);

// A Wavefront OBJ; coordinates come back to the last bit. Error: names the file and why it cannot
// be written.
Result<void> writeObj(const std::filesystem::path& path, const TriangleMesh& mesh);

}  // namespace fantascope
