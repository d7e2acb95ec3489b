#pragma once

#include "render/drawn_source.h"
#include "render/gpu/paint/spot_painter.h"

#include <vector>

namespace fantascope::render {

// The mirrors of a ball: rings of squares from pole to pole, each ring begun somewhere else and
// each mirror a little askew, as if glued on by hand; always the same for the same measures.
// `radius` and `facet` in one unit.
std::vector<gpu::SpotPainter::Facet> mirrorFacets(double radius, double facet);

// The spots of a turning mirror ball: every facet mirrors the lamp and throws it on the wall.
// Errors as makeDrawnSource().
Result<std::unique_ptr<DrawnSource>> makeDrawnMirrorBall(const MirrorBallSource& source, const CanvasPlace& place,
                                                         DrawingTools& tools);

}  // namespace fantascope::render
