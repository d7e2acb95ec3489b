#pragma once

#include "render/gpu/handles.h"

#include "core/result.h"

#include <glm/vec2.hpp>

namespace fantascope::render::gpu {

// A picture of the canvas in which light adds up: one channel of half floats, of linear light, row
// 0 at the canvas's top. Thread: the context's.
class LightCanvas {
public:
    // Error: more pixels than this OpenGL draws.
    static Result<LightCanvas> create(glm::ivec2 size);

    // Makes it the target of drawing, all dark; what is drawn until end() adds up.
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
