#pragma once

#include "render/gpu/canvas_surface.h"
#include "render/gpu/layer_picture.h"

#include "core/result.h"

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <cstddef>
#include <span>
#include <utility>

namespace fantascope::render::gpu {

// Paints a canvas that was drawn as pictures of its own into a LayerPicture, through the output's
// warp. Thread: the context's.
class CanvasPainter {
public:
    // A picture of the canvas: what it lets through, or its light, in one channel.
    struct Picture {
        unsigned texture;             // row 0 at the canvas's top
        glm::vec4 place{1, 1, 0, 0};  // of the canvas in it, 0 .. 1: scale, then offset
    };

    // `pictures`: how many paint() is given. `sharpSamples`: of the sharp picture that paint() is
    // given; 0: none. `bend`: the mesh of the place that it follows. `programs` and `bend` outlive
    // it. Error: a shader does not compile.
    static Result<CanvasPainter> create(std::size_t pictures, int sharpSamples, const Bend& bend, ProgramCache& programs);

    // As CanvasSurface::follow().
    void follow(const CanvasPlace& place) { surface_.follow(place); }
    // Paints into the picture that has begun: from `dark` to `bright`, in linear light, by the
    // product of all pictures and of what `sharp`, of the output's size, leaves uncovered.
    void paint(std::span<const Picture> pictures, const LayerPicture* sharp, glm::vec3 dark, glm::vec3 bright);

private:
    explicit CanvasPainter(CanvasSurface surface) : surface_(std::move(surface)) {}

    CanvasSurface surface_;
};

}  // namespace fantascope::render::gpu
