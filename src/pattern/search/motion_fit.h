#pragma once

#include "pattern/shape/shape_pattern.h"

#include "media/image.h"

namespace fantascope::pattern {

// The pattern's motion settings with magnitudes and ranges fitted to it, for an artist who sets
// none. Local movement is scaled so that LoopQuality::localDisplacement is 15.5 % of the mean size.
// The groups' range is the largest, up to one mean size, that keeps the mean tone over the loop
// within .009 of the tone at rest. If local movement alone exceeds that, it is composed mainly of
// turns; if it still does, the groups stand still. All other settings stay. The results are
// rounded, to be easy to read. `guide`: compared values, in any resolution. `surface`: as measure()
// has it. The result does not depend on `threads`. Thread: reentrant.
MotionSettings fittedMotion(const ShapePattern& pattern, const GreyImage& guide, int threads, const GreyImage* surface = nullptr);

}  // namespace fantascope::pattern
