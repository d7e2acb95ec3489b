#pragma once

#include "vision/watch/wall_reflectance.h"

#include "media/image.h"

#include <glm/vec2.hpp>

#include <cstddef>
#include <map>
#include <vector>

namespace fantascope::vision {

// The light that a white picture on a canvas gives at each of its places, as a camera sees it: from
// each output that shows it. By pixels of the picture.
struct CanvasSurface {
    struct Part {
        std::size_t output = 0;
        GreyImage light;         // as the calibration saw it, linear
        Image<glm::vec2> pixel;  // of the output's projector that lights it; only where `light` is above 0
    };
    std::vector<Part> parts;  // all of one size; at least one

    // `changes`: by output, what its part of the wall gives back now; an output without one is as
    // it was.
    GreyImage light(const std::map<std::size_t, WallChange>& changes = {}) const;
};

}  // namespace fantascope::vision
