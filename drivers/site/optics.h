#pragma once

#include "media/image.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace fantascope::site {

// Blurs light by a Gaussian; the border repeats the edge pixel. `sigma`: pixels; nothing happens at
// 0.
void blurLight(Image<glm::vec3>& light, double sigma);
void blurLight(Image<glm::vec4>& light, double sigma);

// A lens that loses light towards the picture's edge, with the square of the distance from the
// picture's middle. `loss`: the share lost in its corners, 0..1.
void vignette(Image<glm::vec3>& light, double loss);

// Puts something of an even luminance (cd/m2) before a part of the picture: from `low` to `high`,
// shares of its width and height from the top left.
void coverPart(Image<glm::vec3>& light, glm::dvec2 low, glm::dvec2 high, glm::vec3 luminance);

// Adds a share of the picture's mean light everywhere.
void veil(Image<glm::vec3>& light, double share);

}  // namespace fantascope::site
