#pragma once

#include "core/result.h"
#include "media/mesh.h"

#include <string>
#include <string_view>
#include <vector>

namespace fantascope::pattern {

// The shapes that need no file, flat, facing the viewer, the right way up. Their names stand in
// pattern files: none is ever renamed. Besides these there is a letter for every character that can
// be seen: "letter-A".
const std::vector<std::string>& builtInShapeNames();

// How a message lists them all: "triangle, ..., snowflake, letter-A (any character)".
std::string builtInShapeList();

// Whether the name is one of these, whatever a font makes of its letter.
bool isBuiltInShape(std::string_view name);

// The mesh of a built-in shape, in a size of its own. Error: names `name` and what is near to it,
// or why there is no such letter.
Result<TriangleMesh> builtInMesh(const std::string& name);

}  // namespace fantascope::pattern
