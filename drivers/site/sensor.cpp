#include "drivers/site/sensor.h"

#include "core/random.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace fantascope::site {
namespace {

// Fresh normal values for each channel of each pixel would cost more than the picture. 2^17 values
// are many rows' worth, so rows that read the same stretch are rare and far apart.
constexpr std::size_t kNormals = 1 << 17;
// Fine enough for the steepest part of the sRGB curve: a fifth of a stored step.
constexpr std::size_t kLinearSteps = 1 << 14;

}  // namespace

Sensor::Sensor(const Settings& settings, std::uint64_t seed)
    : settings_(settings), seed_(seed), normals_(kNormals), storedOf_(kLinearSteps + 1) {
    Rng rng(seed);
    for (float& value : normals_) value = static_cast<float>(rng.normal());
    for (std::size_t step = 0; step <= kLinearSteps; ++step) {
        const float linear = static_cast<float>(step) / static_cast<float>(kLinearSteps);
        storedOf_[step] = static_cast<std::uint8_t>(std::lround(255 * srgbFromLinear(linear)));
    }
}

RgbaImage Sensor::expose(const Image<glm::vec3>& luminance, std::uint64_t frame) const {
    const float gain = static_cast<float>(1 / settings_.white);
    const float read2 = static_cast<float>(settings_.readNoise * settings_.readNoise);
    const float shot2 = static_cast<float>(settings_.shotNoise * settings_.shotNoise);
    Rng rng(streamSeed(seed_, {frame}));
    RgbaImage image(luminance.width(), luminance.height());
    for (int y = 0; y < luminance.height(); ++y) {
        const auto light = luminance.row(y);
        const auto out = image.row(y);
        std::size_t next = rng.below(kNormals);
        const auto stored = [&](float arriving) {
            const float value = arriving * gain;
            const float noisy = value + std::sqrt(read2 + shot2 * value) * normals_[next++ % kNormals];
            return storedOf_[static_cast<std::size_t>(std::clamp(noisy, 0.0f, 1.0f) * static_cast<float>(kLinearSteps) + 0.5f)];
        };
        for (std::size_t x = 0; x < out.size(); ++x) {
            const std::uint8_t r = stored(light[x].r), g = stored(light[x].g), b = stored(light[x].b);
            out[x] = {r, g, b, 255};
        }
    }
    return image;
}

}  // namespace fantascope::site
