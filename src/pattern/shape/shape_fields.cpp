#include "pattern/shape/shape_fields.h"

#include "pattern/shape/elemental_shape.h"

#include <filesystem>
#include <string>
#include <utility>

namespace fantascope::pattern {
namespace {

// Adds the node's place in the file to the shape's error.
Result<ElementalShape> placed(const ConfigNode& node, Result<ElementalShape> shape) {
    if (!shape) return node.error(shape.error().message());
    return shape;
}

Result<ElementalShape> readBuiltIn(const ConfigNode& node) { return placed(node, builtInShape(TRY(node.text()))); }

Result<ElementalShape> readFromFile(const ConfigNode& node) {
    const std::filesystem::path file = TRY(node.path());
    return placed(node, readShapeFile(file, TRY(node.text())));
}

}  // namespace

void ShapeFields::declare(ConfigFields& fields) {
    fields.optional().read("builtin", builtIn_, readBuiltIn);
    fields.optional().read("file", fromFile_, readFromFile);
}

Result<ElementalShape> ShapeFields::chosen(const ConfigNode& node) && {
    if (builtIn_.has_value() == fromFile_.has_value()) return node.error("exactly one of 'builtin' and 'file' is needed");
    return std::move(builtIn_ ? *builtIn_ : *fromFile_);
}

}  // namespace fantascope::pattern
