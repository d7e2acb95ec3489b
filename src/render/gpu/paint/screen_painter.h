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
        glm::vec3 dark{0}, bright{0};             // linear light in full shadow; what the lamps add to it without shadow
        glm::vec4 canvas{0};                      // from x, y, to x, y; on the unrolled screen if it is curved
        glm::vec4 lit{-1e6f, -1e6f, 1e6f, 1e6f};  // from x, y, to x, y: the lit part of the flat screen
        glm::vec4 curve{0};                       // of a curved screen: the first lamp's place, and the cylinder's radius
    };
    // `samples`: per pixel, of paint()'s `taken`; 0: there is none. `curved`: whether the screen
    // is. `bend`: the mesh of the same output. `programs` and `bend` outlive it. Error: a shader
    // does not compile.
    static Result<ScreenPainter> create(int samples, bool curved, const Bend& bend, ProgramCache& programs);

    // As CanvasSurface::follow().
    void follow(const CanvasPlace& place) { surface_.follow(place); }
    // Paints into the current layer picture. `taken`: texture of what shadows take away, of the
    // output's size; 0: none.
    void paint(const Screen& screen, unsigned taken);

private:
    ScreenPainter(bool curved, CanvasSurface surface) : curved_(curved), surface_(std::move(surface)) {}

    bool curved_;
    CanvasSurface surface_;
};

}  // namespace fantascope::render::gpu
