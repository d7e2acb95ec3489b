#pragma once

#include "media/image.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace fantascope::vision {

// From a camera's stored values to linear light, 0 in the dark and 1 at full white. Whoever reads
// light from a camera's frame reads it here. Value type; thread-safe to read.
class CameraLight {
public:
    CameraLight() = default;  // as sRGB is stored, without hot pixels
    // `response`: the light of stored values that lie evenly from 0 to 255, straight between them;
    // empty: sRGB. `hotPixels`: those that show light in the dark, in the camera's pixels. They
    // show what the nearest sound pixel of their row shows.
    CameraLight(std::span<const double> response, std::span<const glm::ivec2> hotPixels);

    // The light of each stored value.
    const std::array<float, 256>& ofStored() const { return linear_; }
    // The light of a pixel; beside the picture, of the nearest one.
    glm::vec3 at(const RgbaImage& frame, int x, int y) const;
    // Adds the mean of the channels' light to every pixel of `sum`; 1 where a channel is saturated,
    // because then the mean says nothing. Both have one size.
    void addTo(GreyImage& sum, const RgbaImage& frame) const;

private:
    std::array<float, 256> linear_ = linearOfBytes();
    std::vector<std::pair<glm::ivec2, int>> hot_;  // by row and column; the column that stands in
};

}  // namespace fantascope::vision
