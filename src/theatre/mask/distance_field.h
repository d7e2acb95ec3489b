#pragma once

#include "theatre/mask/bit_mask.h"

#include "media/image.h"

namespace fantascope::theatre {

// Of every pixel of a mask, the distance to its contour, pixels: positive in the white, negative
// outside; exact distances between pixel centres, less a half (Felzenszwalb & Huttenlocher 2012).
GreyImage signedDistance(const BitMask& mask);
// The pixels that are farther in than this: those of a mask that has shrunk by so much, or grown by
// as much below zero.
BitMask deeperThan(const GreyImage& distance, double depth);

}  // namespace fantascope::theatre
