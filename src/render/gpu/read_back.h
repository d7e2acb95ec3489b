#pragma once

#include "core/image.h"

#include <glm/vec2.hpp>

namespace fantascope::render::gpu {

// Reads the stored values of a framebuffer into `image`, row 0 at the top; `image` takes `size` if it has another. Waits until everything
// before it has been drawn.
void readBack(unsigned framebuffer, glm::ivec2 size, RgbaImage& image);

}  // namespace fantascope::render::gpu
