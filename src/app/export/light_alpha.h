#pragma once

#include "media/image.h"

#include <string_view>

namespace fantascope::app {

// How black becomes clear for another program, by the values in which that one lays one picture
// over another.
enum class Alpha {
    None,    // it does not: the frame as it is, opaque
    Stored,  // sRGB values as they are stored: most editing, painting and presenting programs
    Linear   // linear light: renderers, and compositors that work in it
};
constexpr std::string_view name(Alpha alpha) {
    return alpha == Alpha::None ? "none" : alpha == Alpha::Stored ? "stored" : "linear";
}  // in options and reports

// A frame of light as a picture with alpha: black is clear, and what shines covers as much as it
// shines. Per pixel, with L the frame's red, green and blue in those values, 0..1:
//     alpha = max(L.r, L.g, L.b),  colour = L / alpha (not premultiplied), and colour = 0 where alpha = 0.
// So alpha * colour = L: laid over black ("over", Porter & Duff 1984) it gives the frame again, to
// half a step of its 8 bits. The colour is stored as sRGB in either case, and alpha as it is. Over
// anything else it covers: light that is to be added, as a second projector's would be, needs no
// alpha but the frame itself and the program's "add" in linear light.
// `alpha` is not None.
Rgba16Image withAlpha(const RgbaImage& frame, Alpha alpha);

}  // namespace fantascope::app
