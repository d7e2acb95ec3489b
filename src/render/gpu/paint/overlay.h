#pragma once

#include "render/gpu/handles.h"
#include "render/gpu/program_cache.h"

#include "core/result.h"
#include "media/image.h"

#include <glm/vec2.hpp>

#include <memory>

namespace fantascope::render::gpu {

// A picture in a projector's own pixels that lies over everything, unaffected by the projector's
// colours, blend and warp. Thread: the context's.
class Overlay {
public:
    // `size`: pixels of the projector. `programs` outlives it. Error: a shader does not compile.
    static Result<Overlay> create(glm::ivec2 size, ProgramCache& programs);

    // `picture`: stored values, of the projector's size, colours multiplied by alpha; null: none.
    void show(const RgbaImage* picture);
    // Paints it over `framebuffer`.
    void paint(unsigned framebuffer);

private:
    Overlay(glm::ivec2 size, unsigned program) : size_(size), program_(program) {}

    glm::ivec2 size_;
    unsigned program_;
    VertexArray noVertices_;
    std::unique_ptr<Texture> picture_;  // null: none
};

}  // namespace fantascope::render::gpu
