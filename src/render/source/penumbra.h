#pragma once

#include "render/source/picture_source.h"

#include "media/image.h"

#include <glm/vec2.hpp>

namespace fantascope::render {

// The diameter of the sun's image behind a small hole, which is the width of an edge's penumbra: d
// tan(theta), in the unit of `distance`. `distance`: from the leaves to where their shadow falls.
// `angle`: the sun's angular diameter, radians. Source: Ji et al. 2015, section 5.1; the paper
// calls it a radius once and a diameter once, and only the diameter is physical.
double penumbraWidth(double distance, double angle);

// A disc as a filter: how much of each pixel it covers, divided by the sum. `diameter`: pixels, >=
// 0. The sides are odd and as short as possible.
GreyImage discFilter(double diameter);

// A picture as a centred filter, `width` (> 0) pixels wide: averaged over each pixel's area,
// divided by the sum. `light`: linear light, not all 0.
GreyImage pictureFilter(const GreyImage& light, double width);

// The grid of pixels in which a blurred layer is painted and blurred. A wide blur needs no fine
// grid, so the pitch is the coarsest of 1, 2, 4, ... output pixels at which the blur's radius is at
// least kMinRadius grid pixels; twice that beyond a pitch of 2, where a coarser grid saves little.
struct BlurGrid {
    double pitch = 0;    // distance between pixels, canvas heights
    glm::ivec2 size{0};  // pixels, with a margin of one around the canvas for interpolation at its edges
    int block = 1;       // painted pixels per grid pixel, each way: painting is finer, to catch small holes
    GreyImage filter;

    static constexpr double kMinRadius = 4;
    // For a canvas [0, aspect] x [0, 1] that is `rows` pixels high in the output.
    static BlurGrid forFilter(const ShadowFilter& filter, double aspect, double rows);
};

}  // namespace fantascope::render
