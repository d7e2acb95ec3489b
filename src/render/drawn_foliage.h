#pragma once

#include "render/drawn_source.h"

namespace fantascope::render {

// Leaves in the sun. A sharp layer goes straight through the warp like every pattern; a blurred one
// is painted and blurred in a picture of its own, on a grid that suits its blur (BlurGrid), and
// drawn through the warp from there. Errors as makeDrawnSource().
Result<std::unique_ptr<DrawnSource>> makeDrawnFoliage(const FoliageSource& source, const CanvasPlace& place, DrawingTools& tools);

}  // namespace fantascope::render
