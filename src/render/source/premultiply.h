#pragma once

#include "media/image.h"

#include <span>

namespace fantascope::render {

// Converts straight alpha to premultiplied alpha, which can be filtered: each colour becomes the
// sRGB value of its linear light times alpha. Thread-safe.
void premultiply(std::span<Rgba8> pixels);

}  // namespace fantascope::render
