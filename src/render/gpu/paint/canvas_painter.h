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

// Paints pictures of a canvas into a LayerPicture, through the output's warp. Thread: the
// context's.
class CanvasPainter {
public:
    // A picture of the canvas with one channel: its transmission or its light.
    struct Picture {
        unsigned texture;             // row 0 at the canvas's top
        glm::vec4 place{1, 1, 0, 0};  // of the canvas in the texture, 0 .. 1: scale, then offset
    };

    // `pictures`: how many paint() gets. `sharpSamples`: samples per pixel of paint()'s `sharp`; 0:
    // there is none. `bend`: the mesh of the same output. `programs` and `bend` outlive it. Error:
    // a shader does not compile.
    static Result<CanvasPainter> create(std::size_t pictures, int sharpSamples, const Bend& bend, ProgramCache& programs);

    // As CanvasSurface::follow().
    void follow(const CanvasPlace& place) { surface_.follow(place); }
    // Paints into the current layer picture: from `dark` to `bright`, in linear light, by the
    // product of all pictures and of the uncovered share of `sharp`, which has the output's size.
    void paint(std::span<const Picture> pictures, const LayerPicture* sharp, glm::vec3 dark, glm::vec3 bright);

private:
    explicit CanvasPainter(CanvasSurface surface) : surface_(std::move(surface)) {}

    CanvasSurface surface_;
};

}  // namespace fantascope::render::gpu
