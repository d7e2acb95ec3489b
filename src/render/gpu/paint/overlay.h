#pragma once

#include "render/gpu/handles.h"
#include "render/gpu/program_cache.h"

#include "core/result.h"
#include "media/image.h"

#include <glm/vec2.hpp>

#include <memory>

namespace fantascope::render::gpu {

// A picture in a projector's own pixels that lies over everything and passes nothing of what
// becomes of light. Thread: the context's.
class Overlay {
public:
    // `size`: pixels of the projector. `programs` outlives it. Error: a shader does not compile.
    static Result<Overlay> create(glm::ivec2 size, ProgramCache& programs);

    // Stored values of the projector's size, colours multiplied by alpha; null: nothing lies over
    // the picture.
    void show(const RgbaImage* picture);
    // Over what `framebuffer` holds.
    void paint(unsigned framebuffer);

private:
    Overlay(glm::ivec2 size, unsigned program) : size_(size), program_(program) {}

    glm::ivec2 size_;
    unsigned program_;
    VertexArray noVertices_;
    std::unique_ptr<Texture> picture_;  // null: nothing lies over the picture
};

}  // namespace fantascope::render::gpu
