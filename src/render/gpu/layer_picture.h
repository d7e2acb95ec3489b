#pragma once

#include "render/gpu/handles.h"

#include "core/result.h"

#include <glm/vec2.hpp>

namespace fantascope::render::gpu {

// The picture into which one layer is painted at full opacity. It has several samples per pixel for
// smooth edges, each with a depth.
//
// A sample holds the square root of its linear light in 8 bits. That is nearly as evenly spaced as
// sRGB, and cheap: a software OpenGL would spend most of a frame on encoding every sample as sRGB.
// Its alpha is the square root of the coverage: 1 where shapes are, else 0. Thread: the context's.
class LayerPicture {
public:
    // Error: more samples or pixels than OpenGL allows here.
    static Result<LayerPicture> create(glm::ivec2 size, int samples);

    // Makes it the render target, black and uncovered.
    void begin();

    int samples() const { return samples_; }  // per pixel; at least as many as were asked for
    unsigned texture() const { return roots_.name(); }

private:
    explicit LayerPicture(glm::ivec2 size) : size_(size) {}

    glm::ivec2 size_;
    int samples_ = 0;
    MultisampleTexture roots_;
    Renderbuffer depth_;
    Framebuffer framebuffer_;
};

}  // namespace fantascope::render::gpu
