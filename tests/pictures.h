#pragma once

#include "media/image.h"

#include <glm/vec2.hpp>

#include <algorithm>
#include <cstdint>
#include <cstdlib>

namespace fantascope {

// Grey: 1 where it is white, else 0.
template <class IsWhite>
GreyImage pictureOf(int width, int height, IsWhite isWhite) {
    GreyImage picture(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) picture.at(x, y) = isWhite(x, y) ? 1.0f : 0.0f;
    return picture;
}

inline bool isIn(int x, int y, int left, int top, int width, int height) {
    return x >= left && x < left + width && y >= top && y < top + height;
}

// One colour, lighter and darker from pixel to pixel: what a conversion makes of it is known to a
// step or two, in every format.
inline Rgba8 shadeAt(int x, int y) {
    const int light = 60 + (37 * x + 53 * y) % 90;
    const auto channel = [&](int more) { return static_cast<std::uint8_t>(light + more); };
    return {channel(50), channel(0), channel(-30), 255};
}
inline RgbaImage shaded(glm::ivec2 size) {
    RgbaImage picture(size.x, size.y);
    for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x) picture.at(x, y) = shadeAt(x, y);
    return picture;
}

// The greatest difference in any channel, and where. `wanted` may be larger.
struct WorstPixel {
    int most = 0;
    glm::ivec2 at{0};
};
inline WorstPixel differenceOf(const RgbaImage& seen, const RgbaImage& wanted) {
    WorstPixel difference;
    for (int y = 0; y < seen.height(); ++y)
        for (int x = 0; x < seen.width(); ++x) {
            const Rgba8 a = seen.at(x, y), b = wanted.at(x, y);
            const int most = std::max({std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b), std::abs(a.a - b.a)});
            if (most > difference.most) difference = {most, {x, y}};
        }
    return difference;
}

}  // namespace fantascope
