#pragma once

#include "pattern/search/pattern_search.h"
#include "pattern/shape/shape_pattern.h"

#include <cstdint>

namespace fantascope::pattern {

// Chooses an instance's colour from those that the options give its shape. Linear light, rounded to
// 4 decimals. The random choice depends on the seed and the instance's id alone. `aspect`: of the
// canvas.
glm::vec3 colourOf(const ShapeInstance& instance, double aspect, std::uint64_t seed, const PatternSearch::Options& options);

}  // namespace fantascope::pattern
