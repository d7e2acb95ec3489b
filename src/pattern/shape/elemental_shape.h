#pragma once

#include "pattern/shape/shape_pattern.h"

#include "core/result.h"
#include "media/mesh.h"

#include <filesystem>
#include <string>

namespace fantascope::pattern {

// An elemental shape from a mesh: moved so that the centroid of its surface is the origin, and
// scaled to radius 1.
// Error: the mesh has no triangles or too many, or has (nearly) no area seen from the front, along
// -z.
Result<ElementalShape> makeShape(std::string name, TriangleMesh mesh);

// A built-in shape, such as "maple-leaf" or "letter-A". Error: as builtInMesh().
Result<ElementalShape> builtInShape(const std::string& name);

// A mesh (see readMesh), or a flat shape from an SVG or a picture (see readOutline). Error: names
// the file and says why.
Result<ElementalShape> readShapeFile(const std::filesystem::path& file, const std::string& name);

// The built-in shape of that name, else the shape in the file at that path. Error: as
// builtInShape() and readShapeFile().
Result<ElementalShape> loadShape(const std::string& nameOrFile);

}  // namespace fantascope::pattern
