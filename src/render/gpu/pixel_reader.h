#pragma once

#include "render/gpu/handles.h"

#include "core/result.h"
#include "media/image.h"

#include <glm/vec2.hpp>

namespace fantascope::render::gpu {

// Copies a framebuffer's pixels to memory without stalling the GPU: start() only queues the copy.
// The memory stays mapped as long as the reader exists, so copyTo() needs no context. Thread: the
// context's, except for copyTo().
class PixelReader {
public:
    // Error: OpenGL has no memory left.
    static Result<PixelReader> create(glm::ivec2 size);

    // Queues a copy of `framebuffer`'s stored values after all drawing so far. It replaces the
    // previous copy.
    void start(unsigned framebuffer);
    // Whether the copy is complete; never waits.
    bool finished() { return copied_.passed(); }
    // Waits until the copy is complete.
    void wait() { copied_.wait(); }
    // Writes a complete copy into `image` of the same size, row 0 at the top. Thread: any, until
    // the next start().
    void copyTo(RgbaImage& image) const;

private:
    explicit PixelReader(glm::ivec2 size) : size_(size) {}

    glm::ivec2 size_;
    Buffer pixels_;
    const Rgba8* mapped_ = nullptr;  // in OpenGL's row order, the bottom row first
    Fence copied_;
};

}  // namespace fantascope::render::gpu
