#pragma once

#include "pattern/shape/shape_pattern.h"

#include "core/config/config.h"
#include "core/result.h"

#include <optional>

namespace fantascope::pattern {

// The keys by which a file names an elemental shape: exactly one of `builtin` and `file`.
class ShapeFields {
public:
    void declare(ConfigFields& fields);
    // The shape that was named; called after fields.finish(). A shape from a file is named as the
    // `file` key writes it. Error: both keys, or none.
    Result<ElementalShape> chosen(const ConfigNode& node) &&;

private:
    std::optional<ElementalShape> builtIn_, fromFile_;
};

}  // namespace fantascope::pattern
