#pragma once

#include "theatre/mask/bit_mask.h"

#include "media/image.h"

namespace fantascope::theatre {

// The signed distance of every pixel to the mask's border, in pixels: positive in the white,
// negative outside. It is the exact distance between pixel centres, less a half (Felzenszwalb &
// Huttenlocher 2012).
GreyImage signedDistance(const BitMask& mask);
// The pixels whose signed distance exceeds `depth`: the mask eroded by `depth` pixels, or dilated
// if `depth` is negative.
BitMask deeperThan(const GreyImage& distance, double depth);

}  // namespace fantascope::theatre
