#pragma once

#include "render/gpu/handles.h"

#include "core/result.h"
#include "media/image.h"

#include <glm/vec2.hpp>

namespace fantascope::render::gpu {

// Copies a framebuffer's pixels to memory without stopping the drawing: start() only queues the
// copy. The memory is the program's too for as long as the reader lives, so that whoever wants the
// pixels takes them without the context. Thread: the context's, but for copyTo().
class PixelReader {
public:
    // Error: OpenGL has no memory left.
    static Result<PixelReader> create(glm::ivec2 size);

    // Queues a copy of `framebuffer`'s stored values as they are after all drawing so far. It takes
    // the place of the one before.
    void start(unsigned framebuffer);
    // Whether the copy that start() queued is done; never waits.
    bool finished() { return copied_.passed(); }
    // Waits until it is.
    void wait() { copied_.wait(); }
    // Puts a finished copy into `image` of the same size, row 0 at the top. Thread: any, until the
    // next start().
    void copyTo(RgbaImage& image) const;

private:
    explicit PixelReader(glm::ivec2 size) : size_(size) {}

    glm::ivec2 size_;
    Buffer pixels_;
    const Rgba8* mapped_ = nullptr;  // GL's row order: the bottom row first
    Fence copied_;
};

}  // namespace fantascope::render::gpu
