#pragma once

#include "media/image.h"

#include <string_view>

namespace fantascope::app {

// How black becomes transparent for another program. It depends on the values in which that program
// composites.
enum class Alpha {
    None,    // not at all: the frame as it is, opaque
    Stored,  // it composites stored sRGB values, as most editing, painting and presenting programs do
    Linear   // it composites linear light, as renderers and some compositors do
};
// As options and reports write it.
constexpr std::string_view name(Alpha alpha) {
    return alpha == Alpha::None ? "none" : alpha == Alpha::Stored ? "stored" : "linear";
}

// A frame of light as a picture with alpha: black is transparent, and light is as opaque as it is
// bright. Per pixel, with L the frame's red, green and blue in those values, 0..1:
//         alpha = max(L.r, L.g, L.b)
//     colour = L / alpha (not premultiplied), or 0 where alpha = 0
// So alpha * colour = L: composited over black ("over", Porter & Duff 1984) it gives the frame
// again, within half a step of 8 bits. The colour is stored as sRGB in either case, alpha as it is.
// Over another picture it hides it. Light that should add to another picture, like a second
// projector's, needs no alpha: use the frame itself and the program's "add" in linear light.
// `alpha` is not None.
Rgba16Image withAlpha(const RgbaImage& frame, Alpha alpha);

}  // namespace fantascope::app
