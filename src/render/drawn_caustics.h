#pragma once

#include "render/drawn_source.h"

namespace fantascope::render {

// Light under water: the rays of a grid on the surface are followed to the floor, and the light of
// every triangle of them adds up there in a picture of the canvas. Errors as makeDrawnSource().
Result<std::unique_ptr<DrawnSource>> makeDrawnCaustics(const CausticsSource& source, const CanvasPlace& place,
                                                       DrawingTools& tools);

}  // namespace fantascope::render
