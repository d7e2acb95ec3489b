#pragma once

#include "render/gpu/handles.h"

#include "core/result.h"

#include <glm/vec2.hpp>

namespace fantascope::render::gpu {

// A picture of the canvas that accumulates light: one channel of half floats, linear light, row 0
// at the canvas's top. Thread: the context's.
class LightCanvas {
public:
    // Error: more pixels than OpenGL allows here.
    static Result<LightCanvas> create(glm::ivec2 size);

    // Makes it the render target, black. Everything drawn until end() adds up.
    void begin();
    void end();

    unsigned texture() const { return light_.name(); }

private:
    explicit LightCanvas(glm::ivec2 size) : size_(size) {}

    glm::ivec2 size_;
    Texture light_;
    Framebuffer framebuffer_;
};

}  // namespace fantascope::render::gpu
