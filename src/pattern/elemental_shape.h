#pragma once

#include "pattern/shape_pattern.h"

#include "core/mesh.h"
#include "core/result.h"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace fantascope::pattern {

// The names of the shapes that need no file: flat, facing the viewer.
const std::vector<std::string>& builtInShapeNames();

// A mesh made an elemental shape: moved so that the centre of its surface (by area) is the origin, and scaled to radius 1.
// Error: its front view, along -z, shows (nearly) no area.
Result<ElementalShape> makeShape(std::string name, TriangleMesh mesh);

// A built-in shape by its name, or the mesh file of that path. Error: names the file and the reason; a word that is neither is
// answered with the nearest built-in name.
Result<ElementalShape> loadShape(const std::string& nameOrFile);

}  // namespace fantascope::pattern
