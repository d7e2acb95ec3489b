#pragma once

#include "theatre/mask/bit_mask.h"

#include <glm/vec2.hpp>

#include <vector>

namespace fantascope::plot {

// The line between white and black as closed rings (the first point comes again at the end),
// through the middles of the pixels' sides, in pixels: around the white clockwise as seen, around
// its holes anticlockwise. What is beyond the mask's edge is black. Pixels that touch at a corner
// alone are apart.
std::vector<std::vector<glm::dvec2>> maskOutline(const theatre::BitMask& mask);

}  // namespace fantascope::plot
