#pragma once

#include "render/gpu/canvas_surface.h"

#include "core/result.h"

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <utility>

namespace fantascope::render::gpu {

// Paints a shadow theatre's screen into a LayerPicture: what shadows have left of the lamps' light. Thread: the context's.
class ScreenPainter {
public:
    // `samples`: a pixel, of the picture of shadows. `bend`: the mesh of the place that it follows. `programs` and `bend` outlive it. Error: a shader does
    // not compile.
    static Result<ScreenPainter> create(int samples, const Bend& bend, ProgramCache& programs);

    // As CanvasSurface::follow().
    void follow(const CanvasPlace& place) { surface_.follow(place); }
    // Paints into the picture that has begun. `taken`: what shadows take away, of the output's size; `dark`: the light in full shadow, `bright`: what
    // comes to it where nobody stands before a lamp, linear; `lit`: the part of the canvas that is lit at all, 0 .. 1: left, top, right, bottom.
    void paint(unsigned taken, glm::vec3 dark, glm::vec3 bright, glm::vec4 lit);

private:
    explicit ScreenPainter(CanvasSurface surface) : surface_(std::move(surface)) {}

    CanvasSurface surface_;
};

}  // namespace fantascope::render::gpu
