#pragma once

#include "render/gpu/handles.h"

#include "core/result.h"

#include <glm/vec2.hpp>

namespace fantascope::render::gpu {

// The picture of one layer while it is painted, at full opacity, with several samples a pixel for
// smooth edges and a depth for each.
//
// A sample holds the square root of its linear light in 8 bits: nearly the spacing of sRGB, and
// cheap, where a software OpenGL would spend most of a frame on encoding every sample. Its alpha is
// the square root of how much is covered: 1 where shapes are, else 0. Thread: the context's.
class LayerPicture {
public:
    // Error: more samples or pixels than this OpenGL has.
    static Result<LayerPicture> create(glm::ivec2 size, int samples);

    // Makes it the target of drawing, all black and uncovered.
    void begin();

    int samples() const { return samples_; }  // a pixel; at least as many as were asked for
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
