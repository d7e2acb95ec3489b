#pragma once

#include "media/image.h"

#include <span>

namespace fantascope::render {

// Straight alpha to what adds up and can be filtered: each colour becomes the sRGB value of its
// light times alpha. Thread-safe.
void premultiply(std::span<Rgba8> pixels);

}  // namespace fantascope::render
