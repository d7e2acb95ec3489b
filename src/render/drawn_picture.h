#pragma once

#include "render/drawn_source.h"

namespace fantascope::render {

// Pictures that fill the canvas of `place`, corner to corner, whatever their aspect. Errors as
// makeDrawnSource().
Result<std::unique_ptr<DrawnSource>> makeDrawnImage(const ImageSource& source, const CanvasPlace& place, DrawingTools& tools);
Result<std::unique_ptr<DrawnSource>> makeDrawnVideo(const VideoSource& source, const CanvasPlace& place, DrawingTools& tools);
Result<std::unique_ptr<DrawnSource>> makeDrawnCamera(const CameraSource& source, const CanvasPlace& place, DrawingTools& tools);

// A picture that fills an output of `size` pixels, without its warp.
Result<std::unique_ptr<DrawnSource>> makeDrawnCard(const ImageSource& source, glm::ivec2 size, DrawingTools& tools);

}  // namespace fantascope::render
