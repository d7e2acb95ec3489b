#pragma once

#include "pattern/shape/shape_pattern.h"

#include "core/config.h"
#include "core/result.h"

#include <optional>

namespace fantascope::pattern {

// The keys by which a file names an elemental shape: `builtin` or `file`, of which exactly one must
// stand there.
class ShapeFields {
public:
    void declare(ConfigFields& fields);
    // After fields.finish(). A file's shape has the name by which the file calls it. Error: both
    // keys, or none.
    Result<ElementalShape> chosen(const ConfigNode& node) &&;

private:
    std::optional<ElementalShape> builtIn_, fromFile_;
};

}  // namespace fantascope::pattern
