#pragma once

#include "media/image.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <vector>

namespace fantascope::site {

// A camera's sensor: exposure, noise, and the sRGB curve. Thread: const methods are reentrant.
class Sensor {
public:
    struct Settings {
        double white = 40;         // cd/m2 that is just stored as full white; > 0
        double readNoise = 0.002;  // standard deviation in the dark, as a share of white
        double shotNoise = 0.01;   // additional deviation at full white; its square is proportional to the light
    };
    // `seed`: of the noise.
    Sensor(const Settings& settings, std::uint64_t seed);

    // The stored picture of a luminance (cd/m2). The noise depends only on the seed and the frame's
    // number.
    RgbaImage expose(const Image<glm::vec3>& luminance, std::uint64_t frame) const;

private:
    Settings settings_;
    std::uint64_t seed_;
    std::vector<float> normals_;          // standard normal values; each row of a frame reads on from its own place
    std::vector<std::uint8_t> storedOf_;  // by linear value
};

}  // namespace fantascope::site
