#pragma once

#include "pattern/shape_pattern.h"

#include "core/image.h"

namespace fantascope::pattern {

// How well a pattern at rest reads as its guide, all in the pattern's resolution and in the guide's stored values.
struct PatternQuality {
    double z = 1;        // mean |I - I'| (Ji et al. 2015, section 4.1)
    double zBound = 0;   // mean min(I, 1 - I): no white shapes on black have less
    double tone = 1;     // mean |G*I - G*I'|, G a Gaussian of sigma = height / 36: what the eye sees from afar
    double overlap = 0;  // the share of covered pixels that several instances cover
};

// `guide`: stored values, in any resolution; the pattern's is used.
PatternQuality measure(const ShapePattern& pattern, const GreyImage& guide);

// Mean z over the animated loop, which is what an audience sees: at so many moments, evenly spread. The result does not depend on
// `threads`.
double loopZ(const ShapePattern& pattern, const GreyImage& guide, int moments, int threads);

// The pattern at rest, white on black, as it is compared with the guide.
GreyImage drawWhiteOnBlack(const ShapePattern& pattern, int width, int height);

}  // namespace fantascope::pattern
