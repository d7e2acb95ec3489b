#pragma once

#include "render/source/picture_source.h"

#include "media/image.h"

#include <glm/vec2.hpp>

namespace fantascope::render {

// How wide the sun's image behind a small hole is, and how wide an edge's penumbra: d tan(theta),
// in the unit of `distance`, which is from the leaves to what their shadow falls on. `angle`:
// radians that the sun appears under. Source: Ji et al. 2015, section 5.1; the paper calls it a
// radius once and a diameter once, and only the diameter is physical.
double penumbraWidth(double distance, double angle);

// A round spot of light of this diameter in pixels, at least 0: how much of each pixel it covers,
// divided by the sum. Odd sides, as small as they can be.
GreyImage discFilter(double diameter);

// A picture as a filter, `width` pixels wide, its middle in the middle: averaged over areas,
// divided by the sum. `light`: linear light, some of it above 0. width > 0.
GreyImage pictureFilter(const GreyImage& light, double width);

// The grid of pixels in which a blurred layer is painted and blurred. A wide blur leaves nothing
// that a fine grid is needed for: the coarsest grid of 1, 2, 4, ... pixels of the output is taken
// in which the blur's radius is still kLeastRadius, or twice that where it is coarser than 2, since
// there nothing more is won.
struct BlurGrid {
    double pitch = 0;    // canvas heights from pixel to pixel
    glm::ivec2 size{0};  // pixels, a frame of one around the canvas included, so that its edges can be interpolated too
    int block = 1;       // painted pixels to one of these, each way: painting is finer, so that no small hole is missed
    GreyImage filter;

    static constexpr double kLeastRadius = 4;
    // For a canvas [0, aspect] x [0, 1] whose height is `rows` pixels in the output.
    static BlurGrid forFilter(const ShadowFilter& filter, double aspect, double rows);
};

}  // namespace fantascope::render
