#pragma once

#include "core/result.h"

#include <glm/vec2.hpp>

namespace fantascope::drivers {

// Makes a black picture of stored sRGB values (GL_SRGB8_ALPHA8) in the current context and returns
// the GL name of its framebuffer. It lives as long as the context. Error: larger than this OpenGL
// can draw.
Result<unsigned> makeSrgbFramebuffer(glm::ivec2 size);

}  // namespace fantascope::drivers
