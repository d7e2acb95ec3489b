#pragma once

#include "render/gpu/handles.h"
#include "render/gpu/layer_picture.h"
#include "render/gpu/program_cache.h"

#include "core/result.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <cstddef>
#include <span>

namespace fantascope::render::gpu {

// Paints a canvas that was drawn as pictures of its own into a LayerPicture, through the output's warp. Thread: the context's.
class CanvasPainter {
public:
    // A picture of the canvas: what it lets through, or its light, in one channel.
    struct Picture {
        unsigned texture;             // row 0 at the canvas's top
        glm::vec4 place{1, 1, 0, 0};  // of the canvas in it, 0 .. 1: scale, then offset
    };

    // `clipFromCanvas`: of a canvas that is 0 .. 1 in both directions. `pictures`: how many paint() is given. `sharpSamples`: of the
    // sharp picture that paint() is given; 0: none. `programs` outlives it. Error: a shader does not compile.
    static Result<CanvasPainter> create(const glm::mat3& clipFromCanvas, std::size_t pictures, int sharpSamples,
                                        ProgramCache& programs);

    // Paints into the picture that has begun: from `dark` to `bright`, in linear light, by the product of all pictures and of what
    // `sharp`, of the output's size, leaves uncovered.
    void paint(std::span<const Picture> pictures, const LayerPicture* sharp, glm::vec3 dark, glm::vec3 bright);

private:
    CanvasPainter(unsigned program, const glm::mat3& clipFromCanvas) : program_(program), clipFromCanvas_(clipFromCanvas) {}

    unsigned program_;
    glm::mat3 clipFromCanvas_;
    VertexArray noVertices_;
};

}  // namespace fantascope::render::gpu
