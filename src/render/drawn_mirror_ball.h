#pragma once

#include "render/drawn_source.h"
#include "render/gpu/paint/spot_painter.h"

#include <vector>

namespace fantascope::render {

// The mirrors of a ball: rings of squares from pole to pole. Each ring starts at another angle and
// each mirror is a little askew, as if glued on by hand. The same arguments give the same mirrors.
// `radius` and `facet`: in the same unit.
std::vector<gpu::SpotPainter::Facet> mirrorFacets(double radius, double facet);

// The spots of a turning mirror ball: every facet reflects the lamp onto the wall. Errors as
// makeDrawnSource().
Result<std::unique_ptr<DrawnSource>> makeDrawnMirrorBall(const MirrorBallSource& source, const CanvasPlace& place,
                                                         DrawingTools& tools);

}  // namespace fantascope::render
