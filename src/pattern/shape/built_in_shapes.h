#pragma once

#include "core/result.h"
#include "media/mesh.h"

#include <string>
#include <string_view>
#include <vector>

namespace fantascope::pattern {

// The names of the built-in shapes, which need no file. They are flat, upright and face the viewer.
// Pattern files use these names, so none is ever renamed. Every visible character is a built-in
// shape too, as in "letter-A".
const std::vector<std::string>& builtInShapeNames();

// All of them as messages list them: "triangle, ..., snowflake, letter-A (any character)".
std::string builtInShapeList();

// Whether `name` is a built-in shape. A letter counts even if no font has it.
bool isBuiltInShape(std::string_view name);

// The mesh of a built-in shape, in arbitrary units. Error: quotes `name` and suggests the nearest
// name, or says why there is no such letter.
Result<TriangleMesh> builtInMesh(const std::string& name);

}  // namespace fantascope::pattern
