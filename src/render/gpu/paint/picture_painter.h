#pragma once

#include "render/gpu/canvas_surface.h"
#include "render/gpu/picture_texture.h"

#include "core/result.h"

#include <utility>

namespace fantascope::render::gpu {

// Paints a picture that fills the canvas into a LayerPicture, through the output's warp. Thread:
// the context's.
class PicturePainter {
public:
    // A pixel that covers more texels along a side samples mipmaps.
    static constexpr int kMaxTaps = 8;

    // `bend`: the mesh of the same output. `programs` and `bend` outlive it. Error: a shader does
    // not compile.
    static Result<PicturePainter> create(const Bend& bend, ProgramCache& programs);

    // As CanvasSurface::follow().
    void follow(const CanvasPlace& place) { surface_.follow(place); }

    // Paints into the current layer picture.
    void paint(const PictureTexture& picture);

private:
    explicit PicturePainter(CanvasSurface surface) : surface_(std::move(surface)) {}

    CanvasSurface surface_;
};

}  // namespace fantascope::render::gpu
