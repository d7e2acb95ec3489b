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
    // Places are (x, y) in the screen's frame, metres.
    struct Screen {
        glm::vec3 dark{0}, bright{0};  // linear light in full shadow; what the lamps add to it where nobody is before them
        glm::vec4 canvas{0};           // from x, y, to x, y; unrolled, if the screen is curved
        glm::vec4 lit{-1e6f, -1e6f, 1e6f, 1e6f};  // from x, y, to x, y of the flat screen that is lit at all
        glm::vec4 curve{0};                       // of a curved screen: where the first lamp is, and the cylinder's radius
    };
    // `samples`: a pixel, of the picture of what shadows take away; 0: none is given. `curved`: the
    // screen is. `bend`: the mesh of the place that it follows. `programs` and `bend` outlive it.
    // Error: a shader does not compile.
    static Result<ScreenPainter> create(int samples, bool curved, const Bend& bend, ProgramCache& programs);

    // As CanvasSurface::follow().
    void follow(const CanvasPlace& place) { surface_.follow(place); }
    // Paints into the picture that has begun. `taken`: what shadows take away, of the output's
    // size; 0: nothing.
    void paint(const Screen& screen, unsigned taken);

private:
    ScreenPainter(bool curved, CanvasSurface surface) : curved_(curved), surface_(std::move(surface)) {}

    bool curved_;
    CanvasSurface surface_;
};

}  // namespace fantascope::render::gpu
