#pragma once

#include "render/gpu/canvas_surface.h"

#include "core/result.h"

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <utility>

namespace fantascope::render::gpu {

// Paints a shadow theatre's screen into a LayerPicture. Thread: the context's.
class ScreenPainter {
public:
    struct Screen {
        glm::vec3 dark{0}, bright{0};  // linear light in full shadow; what the lamps add to it where nobody is before them
        glm::vec4 lit{-1e6f, -1e6f, 1e6f, 1e6f};  // the part of the canvas, 0 .. 1, that is lit at all: left, top, right, bottom
    };
    // `samples`: a pixel, of the picture of what shadows take away; 0: none is given. `bend`: the mesh of the place that it follows. `programs` and `bend`
    // outlive it. Error: a shader does not compile.
    static Result<ScreenPainter> create(int samples, const Bend& bend, ProgramCache& programs);

    // As CanvasSurface::follow().
    void follow(const CanvasPlace& place) { surface_.follow(place); }
    // Paints into the picture that has begun. `taken`: what shadows take away, of the output's size; 0: nothing.
    void paint(const Screen& screen, unsigned taken);

private:
    explicit ScreenPainter(CanvasSurface surface) : surface_(std::move(surface)) {}

    CanvasSurface surface_;
};

}  // namespace fantascope::render::gpu
