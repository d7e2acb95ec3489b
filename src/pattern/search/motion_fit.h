#pragma once

#include "pattern/shape/shape_pattern.h"

#include "media/image.h"

namespace fantascope::pattern {

// The pattern's own motion with magnitudes and ranges that suit it, for an artist who names none:
// the local ones so large that the shapes' corners stray from their rest by 15.5 % of the mean size
// (LoopQuality::localDisplacement), and the groups' as large, up to one mean size, as the mean tone
// over the loop stays within .009 of the tone at rest. Where the local movement alone takes more
// than that it is made of turns above all, and the groups stand still if that does not help.
// Everything else of the motion stays as it is; what comes out is rounded for its reader. `guide`:
// stored values, in any resolution. The result does not depend on `threads`. Thread: reentrant.
MotionSettings fittedMotion(const ShapePattern& pattern, const GreyImage& guide, int threads);

}  // namespace fantascope::pattern
