#pragma once

#include "theatre/mask/bit_mask.h"

#include <glm/vec2.hpp>

#include <vector>

namespace fantascope::plot {

// The boundary between white and black as closed rings (the last point equals the first) through
// the middles of the pixels' sides, in pixels. As seen, rings run clockwise around white and
// anticlockwise around holes. Everything beyond the mask's edge is black. Pixels that touch only at
// a corner are separate.
std::vector<std::vector<glm::dvec2>> maskOutline(const theatre::BitMask& mask);

}  // namespace fantascope::plot
