#pragma once

#include "core/result.h"
#include "media/image.h"

#include <glm/vec2.hpp>

#include <span>
#include <vector>

namespace fantascope::vision {

// The same pixels of a still scene at one exposure.
struct ExposedValues {
    double time = 1;             // of the exposure, in any unit
    std::vector<double> stored;  // 0..255, means over frames
};

// How stored values follow light.
struct ResponseFit {
    // Linear light, 0 in the dark and 1 at full white, of stored values that lie evenly from 0 to
    // 255.
    std::vector<double> response;
    double rms = 0;  // of the light, as a share of it: how far exposures and values contradict each other
};

// Finds the response with which every pixel's light is proportional to the time (Debevec & Malik
// 1997). It differs smoothly from sRGB, and follows it where no value tells otherwise. `dark`: the
// stored value without light. Deterministic; takes some 10 ms.
// Error: fewer than two exposures; they tell of too few values.
Result<ResponseFit> fitResponse(std::span<const ExposedValues> exposures, double dark);

// sRGB's response with the dark value at 0, for a camera whose exposure cannot be set.
std::vector<double> srgbResponse(double dark);

// What a camera stores in the dark.
struct DarkFrame {
    double level = 0;                   // 0..255: the median over the pixels
    std::vector<glm::ivec2> hotPixels;  // that are much brighter, row by row
};
// `stored`: the mean stored value of each pixel's brightest channel over some frames, 0..255.
DarkFrame darkFrameOf(const GreyImage& stored);

}  // namespace fantascope::vision
