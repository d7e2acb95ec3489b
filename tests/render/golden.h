#pragma once

#include "media/image.h"

#include <gtest/gtest.h>

#include <string>

namespace fantascope {

// How a picture differs from a golden one, or "" if it looks the same: the rms difference of all
// stored values 0 .. 255 is at most 1.5, and none is larger than 140, which is one sample of four
// at an edge. Another version of OpenGL may place a sample or round a value differently, but it
// moves no edge. Both pictures have the same size.
std::string differsVisibly(const RgbaImage& golden, const RgbaImage& image);

// Whether a picture looks like tests/golden/NAME.png. If not, or if there is no such file yet, the
// message names the pictures in the build folder's golden/: NAME.png is the new one,
// NAME.compare.png shows golden, new and eight times their difference side by side.
// tools/approve-golden makes new pictures golden.
testing::AssertionResult looksLikeGolden(const std::string& name, const RgbaImage& image);

}  // namespace fantascope
