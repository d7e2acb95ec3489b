#pragma once

#include "render/gpu/handles.h"

#include "core/image.h"

#include <glm/vec2.hpp>

#include <cstddef>

namespace fantascope::render::gpu {

// Copies a framebuffer's pixels to memory without stopping the drawing: start() only queues the copy. Thread: the context's.
class PixelReader {
public:
    explicit PixelReader(glm::ivec2 size);

    // Queues a copy of `framebuffer`'s stored values as they are after all drawing so far.
    void start(unsigned framebuffer);
    // Waits for the copy that start() queued and puts it into `image` of the same size, row 0 at the top. Again and again, if wanted.
    void finish(RgbaImage& image);

private:
    glm::ivec2 size_;
    Buffer pixels_;
    const Rgba8* mapped_;  // GL's row order: the bottom row first
    Fence copied_;
};

}  // namespace fantascope::render::gpu
