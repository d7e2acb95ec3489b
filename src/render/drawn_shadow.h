#pragma once

#include "render/drawn_source.h"

namespace fantascope::render {

// A cast's shadow, drawn straight through the output's warp. Errors as makeDrawnSource().
Result<std::unique_ptr<DrawnSource>> makeDrawnShadow(const ShadowSource& source, const CanvasPlace& place, DrawingTools& tools);

}  // namespace fantascope::render
