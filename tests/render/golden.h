#pragma once

#include "media/image.h"

#include <gtest/gtest.h>

#include <string>

namespace fantascope {

// What sets a picture apart from a golden one, or "" when it looks the same: the rms difference of
// all stored values of 0 .. 255 is at most 1.5 and none is larger than 140, which is one sample of
// four at an edge. Another version of OpenGL may place a sample or round a value differently here
// and there, but moves no edge. Both of one size.
std::string differsVisibly(const RgbaImage& golden, const RgbaImage& image);

// Whether a picture still looks like tests/golden/NAME.png. If not, and when there is no such file
// yet, the message names the pictures in the build folder's golden/: NAME.png is the new one,
// NAME.compare.png shows golden, new and eight times their difference side by side.
// tools/approve-golden makes new ones golden.
testing::AssertionResult looksLikeGolden(const std::string& name, const RgbaImage& image);

}  // namespace fantascope
