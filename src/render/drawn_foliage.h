#pragma once

#include "render/drawn_source.h"

namespace fantascope::render {

// Leaves in the sun. A sharp layer is drawn straight through the warp, like every pattern. A
// blurred layer is painted and blurred in a picture of its own, on a grid that suits its blur
// (BlurGrid), and that picture is drawn through the warp. Errors as makeDrawnSource().
Result<std::unique_ptr<DrawnSource>> makeDrawnFoliage(const FoliageSource& source, const CanvasPlace& place, DrawingTools& tools);

}  // namespace fantascope::render
