#pragma once

#include "core/image.h"
#include "core/result.h"

#include <glm/vec2.hpp>

#include <filesystem>
#include <memory>

namespace fantascope::app {

// An H.264 video in an MP4 file, written aside and renamed by finish(). The same pictures give the same bytes: it encodes on the calling
// thread. Thread: thread-bound.
class VideoWriter {
public:
    // `size` in pixels; an odd last column or row is left out, since the colour format has none. `frameRate` in Hz, 1..1000.
    // Error: names the file: cannot be made, or an encoder that is missing.
    static Result<std::unique_ptr<VideoWriter>> open(const std::filesystem::path& file, glm::ivec2 size, double frameRate);
    ~VideoWriter();

    // Shows `picture` (of the size given to open) from frame `number` on; numbers rise, a gap keeps the picture before it.
    Result<void> write(const RgbaImage& picture, std::int64_t number);
    // Ends the file. Without it nothing is left behind.
    Result<void> finish();

private:
    struct Impl;
    explicit VideoWriter(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace fantascope::app
