#pragma once

#include "pattern/shape/shape_pattern.h"

#include "core/wind.h"
#include "media/image.h"

#include <memory>

namespace fantascope::pattern {

// How well a pattern at rest reads as its guide, all in the pattern's resolution and in the guide's
// stored values.
struct PatternQuality {
    double z = 1;        // mean |I - I'| (Ji et al. 2015, section 4.1)
    double zBound = 0;   // mean min(I, 1 - I): no white shapes on black have less
    double tone = 1;     // mean |G*I - G*I'|, G a Gaussian of sigma = height / 36: what the eye sees from afar
    double overlap = 0;  // the share of covered pixels that several instances cover
};

// `guide`: stored values, in any resolution; the pattern's is used.
PatternQuality measure(const ShapePattern& pattern, const GreyImage& guide);

// The animated loop, which is what an audience sees.
struct LoopQuality {
    double z = 1;     // mean over the loop
    double tone = 1;  // mean over the loop; of a smaller picture, which is off by 2 % at most, at the border
    // How far the corners of the shapes stray from their rest by the local movements, translation
    // and rotations as they show on the canvas: root mean square over instances, time and the
    // vertices of each mesh, as a share of the mean size. Groups stand still.
    double localDisplacement = 0;
};

// Judges one pattern's loop. Thread: reentrant.
class LoopMeasure {
public:
    // Computes the pattern's movement. Refers to `pattern`, which must stay; threads change nothing
    // but the time that it takes.
    LoopMeasure(const ShapePattern& pattern, const GreyImage& guide, int threads);
    ~LoopMeasure();

    // At so many moments, evenly spread over one period, in a steady wind.
    LoopQuality in(const Wind& wind, int moments) const;

private:
    struct Parts;
    std::unique_ptr<const Parts> parts_;
};

// The pattern at rest, white on black, as it is compared with the guide.
GreyImage drawWhiteOnBlack(const ShapePattern& pattern, int width, int height);

}  // namespace fantascope::pattern
