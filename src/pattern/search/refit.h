#pragma once

#include "pattern/search/pattern_search.h"

#include "media/image.h"

#include <cstddef>
#include <string>

namespace fantascope::pattern {

// Fits a pattern that is shown to the surface that it is shown on. The search goes on from the
// pattern: instances are made, removed, resized and moved where that wins much, and all others stay
// as they are. A new one takes colour and group of the nearest given one.
struct PatternRefit {
    struct Options {
        // The work: iterations of the search, each of 1000 moves. A bound of time would give
        // another pattern on another machine.
        int iterations = 400;
        double more = 0.25;  // how many instances may be added, as a share of those that there are; 0 .. 4
        // The least that is left of the picture's light, 0.05 .. 1. Where a white place lies on a
        // dark one of the surface, all else has to be darker for it.
        double least = 0.5;
    };

    ShapePattern pattern;
    // How far the picture on the surface is from the guide, seen from afar (PatternQuality::tone),
    // at the exposure at which it has the guide's mean light.
    double toneBefore = 0, toneAfter = 0;
    double kept = 1;  // share of the picture's light that is left
    std::size_t made = 0, removed = 0, changed = 0;

    // The share of the difference that is gone, below 1; below 0: it grew.
    double gain() const { return toneBefore > 0 ? 1 - toneAfter / toneBefore : 0; }

    // `pattern`: has instances, and was compared in light. `guide`: linear light, in any
    // resolution. `light`: the light that a white shape gives at each place of the pattern's
    // canvas, in any resolution and unit; 0 where the canvas ends. `askStop`: as PatternSearch has
    // it. The same arguments give the same result. Thread: reentrant.
    static PatternRefit of(const ShapePattern& pattern, const GreyImage& guide, const GreyImage& light, const Options& options,
                           const PatternSearch::AskStop& askStop);
};

// What toneBefore says.
double toneOnSurface(const ShapePattern& pattern, const GreyImage& guide, const GreyImage& light);

// The light that stands for the guide's white: the highest for which no more than the share
// `missing` of the guide's light cannot be had. `light`: what a white shape gives, in the guide's
// size. 0: it gives none where the guide is lit.
double reachableWhite(const GreyImage& light, const GreyImage& guide, double missing);

}  // namespace fantascope::pattern
