#pragma once

#include "render/gpu/handles.h"

#include "core/result.h"

#include <glm/vec2.hpp>

namespace fantascope::render::gpu {

// A picture with several samples a pixel, for smooth edges, and a depth for each sample. Shaders write linear light; it is stored as sRGB,
// and blended and averaged as light.
class MultisampledPicture {
public:
    // Error: more samples or pixels than this OpenGL has.
    static Result<MultisampledPicture> create(glm::ivec2 size, int samples);

    // Makes it the target of drawing, all black.
    void begin();
    // Averages the samples into `framebuffer` of the same size, whose colours are stored sRGB values.
    void resolveInto(unsigned framebuffer);

private:
    explicit MultisampledPicture(glm::ivec2 size) : size_(size) {}
    glm::ivec2 size_;
    Renderbuffer colour_, depth_;
    Framebuffer framebuffer_;
};

}  // namespace fantascope::render::gpu
