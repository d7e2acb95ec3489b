#pragma once

#include "core/result.h"
#include "media/image.h"

#include <glm/vec2.hpp>

#include <cstdint>
#include <filesystem>
#include <memory>

namespace fantascope::app {

// How a video is coded.
enum class VideoKind {
    Recording,   // H.264 in MP4, coded as quickly as can be: a rehearsal must not slow the show that it records
    Film,        // H.264 in MP4, for people to look at
    ProRes4444,  // in MOV, with alpha: what editing programs read
    Lossless     // FFV1 in Matroska, with alpha, 16 bits a channel
};

// A video file, which has no name before finish() (core/file.h, NewFile). The same pictures give
// the same bytes: it encodes on the calling thread. Colours are sRGB, and labelled so. Thread:
// thread-bound.
class VideoWriter {
public:
    // `size` in pixels; H.264 leaves an odd last column or row out, since its colour format has
    // none. `frameRate` in Hz, 1..1000. `ticks`: how many numbers there are a frame; with several a
    // picture can begin between two. Error: names the file: cannot be made, or an encoder that is
    // missing.
    static Result<std::unique_ptr<VideoWriter>> open(const std::filesystem::path& file, glm::ivec2 size, double frameRate,
                                                     VideoKind kind = VideoKind::Recording, int ticks = 1);
    ~VideoWriter();

    // Shows `picture` (of the size given to open) from frame `number` on; numbers rise, a gap keeps
    // the picture before it, and the last one is shown for one frame. H.264 leaves alpha out, the
    // others take it as straight (not premultiplied).
    Result<void> write(const RgbaImage& picture, std::int64_t number);
    Result<void> write(const Rgba16Image& picture, std::int64_t number);
    // Ends the file. Without it nothing is left behind.
    Result<void> finish();

private:
    struct Impl;
    explicit VideoWriter(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace fantascope::app
