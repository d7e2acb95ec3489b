#include "vision/picture_trouble.h"

#include <algorithm>

namespace fantascope::vision {

PictureTrouble troubleOf(const RgbaImage& picture) {
    constexpr int kDark = 24;             // of 255: nothing brighter is in a black picture, but noise and hot pixels
    constexpr double kFewBright = 0.002;  // this share of its pixels
    constexpr double kMostSaturated = 0.5;
    std::size_t bright = 0, saturated = 0;
    for (const Rgba8& pixel : picture.pixels()) {
        const int most = std::max({pixel.r, pixel.g, pixel.b});
        bright += most > kDark;
        saturated += std::min({pixel.r, pixel.g, pixel.b}) == 255;
    }
    const auto all = static_cast<double>(picture.pixels().size());
    if (static_cast<double>(bright) < kFewBright * all) return PictureTrouble::Black;
    return static_cast<double>(saturated) > kMostSaturated * all ? PictureTrouble::Saturated : PictureTrouble::None;
}

}  // namespace fantascope::vision
