#include "app/export/light_alpha.h"

#include "core/check.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace fantascope::app {
namespace {

std::uint16_t toWord(float value) { return static_cast<std::uint16_t>(std::lround(std::clamp(value, 0.0f, 1.0f) * 65535.0f)); }

}  // namespace

Rgba16Image withAlpha(const RgbaImage& frame, Alpha alpha) {
    FANTASCOPE_CHECK(alpha != Alpha::None, "alpha is Stored or Linear");
    std::array<float, 256> lightOf;
    for (std::size_t stored = 0; stored < lightOf.size(); ++stored) {
        const float value = static_cast<float>(stored) / 255;
        lightOf[stored] = alpha == Alpha::Stored ? value : linearFromSrgb(value);
    }
    const auto colourOf = [&](std::uint8_t channel, std::uint8_t brightest) {
        if (channel == brightest) return std::uint16_t{65535};
        const float share = lightOf[channel] / lightOf[brightest];
        return toWord(alpha == Alpha::Stored ? share : srgbFromLinear(share));
    };
    Rgba16Image picture(frame.width(), frame.height(), Rgba16{0, 0, 0, 0});
    const auto out = picture.pixels();
    for (std::size_t i = 0; i < out.size(); ++i) {
        const Rgba8& pixel = frame.pixels()[i];
        const std::uint8_t brightest = std::max({pixel.r, pixel.g, pixel.b});
        if (brightest == 0) continue;
        out[i] = {colourOf(pixel.r, brightest), colourOf(pixel.g, brightest), colourOf(pixel.b, brightest),
                  toWord(lightOf[brightest])};
    }
    return picture;
}

}  // namespace fantascope::app
