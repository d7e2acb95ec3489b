#pragma once

#include "render/drawn_source.h"

namespace fantascope::render {

// Light under water: the rays of a grid on the surface are traced to the floor, where the light of
// each grid triangle is added to a picture of the canvas. Errors as makeDrawnSource().
Result<std::unique_ptr<DrawnSource>> makeDrawnCaustics(const CausticsSource& source, const CanvasPlace& place,
                                                       DrawingTools& tools);

}  // namespace fantascope::render
