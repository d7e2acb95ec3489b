#pragma once

#include "pattern/shape/shape_pattern.h"

#include "core/result.h"
#include "media/mesh.h"

#include <filesystem>
#include <string>

namespace fantascope::pattern {

// A mesh made an elemental shape: moved so that the centre of its surface (by area) is the origin,
// and scaled to radius 1.
// Error: it has no triangles or too many, or its front view, along -z, shows (nearly) no area.
Result<ElementalShape> makeShape(std::string name, TriangleMesh mesh);

// A built-in shape, as "maple-leaf" or "letter-A". Error: lists them.
Result<ElementalShape> builtInShape(const std::string& name);

// A mesh (see readMesh), or a flat shape from an SVG or a picture (see readOutline). Error: names
// the file and the reason.
Result<ElementalShape> readShapeFile(const std::filesystem::path& file, const std::string& name);

// A built-in shape by its name, or else the file of that path. Error: as theirs.
Result<ElementalShape> loadShape(const std::string& nameOrFile);

}  // namespace fantascope::pattern
