#pragma once

#include "pattern/shape/shape_pattern.h"

#include "core/wind.h"
#include "media/image.h"

#include <memory>

namespace fantascope::pattern {

// How well a pattern at rest reads as its guide, in the pattern's resolution and in the guide's
// compared values (comparedGuide).
struct PatternQuality {
    double z = 1;        // mean |I - I'| (Ji et al. 2015, section 4.1)
    double zBound = 0;   // mean min(I, 1 - I), the lower bound of z for white shapes on black
    double tone = 1;     // mean |G*I - G*I'|, G a Gaussian of sigma = height / 36: the difference seen from afar
    double overlap = 0;  // share of the covered pixels that more than one instance covers
};

// `guide`: compared values, in any resolution; it is resampled to the pattern's. `surface`: what
// the pattern is seen on, as PatternSearch::Options has it; null: evenly white.
PatternQuality measure(const ShapePattern& pattern, const GreyImage& guide, const GreyImage* surface = nullptr);

// The same of the animated loop, which is what an audience sees.
struct LoopQuality {
    double z = 1;     // mean over the loop
    double tone = 1;  // mean over the loop, of a smaller picture; the error is at most 2 %, at the border
    // How far local movement displaces the shapes' vertices on the canvas: root mean square over
    // instances, time and the vertices of each mesh, as a share of the mean size. Group movement is
    // left out.
    double localDisplacement = 0;
};

// Measures one pattern's loop. Thread: reentrant.
class LoopMeasure {
public:
    // Computes the pattern's movement. `pattern` must outlive it. The result does not depend on
    // `threads`. `surface`: as measure() has it.
    LoopMeasure(const ShapePattern& pattern, const GreyImage& guide, int threads, const GreyImage* surface = nullptr);
    ~LoopMeasure();

    // Measures `moments` moments, evenly spaced over one period, in a constant wind.
    LoopQuality in(const Wind& wind, int moments) const;

private:
    struct Parts;
    std::unique_ptr<const Parts> parts_;
};

// The pattern at rest, white on black, as the search compares it with the guide.
GreyImage drawWhiteOnBlack(const ShapePattern& pattern, int width, int height);

}  // namespace fantascope::pattern
