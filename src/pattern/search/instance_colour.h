#pragma once

#include "pattern/search/pattern_search.h"
#include "pattern/shape/shape_pattern.h"

#include <cstdint>

namespace fantascope::pattern {

// The colour of an instance, from those that the options allow its shape; linear light, in short
// decimals. What is random about it depends on the seed and the instance's id alone. `aspect`: the
// canvas's.
glm::vec3 colourOf(const ShapeInstance& instance, double aspect, std::uint64_t seed, const PatternSearch::Options& options);

}  // namespace fantascope::pattern
