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
    Recording,   // H.264 in MP4 with the fastest preset: recording must not slow the show
    Film,        // H.264 in MP4, for people to look at
    ProRes4444,  // in MOV, with alpha: what editing programs read
    Lossless     // FFV1 in Matroska, with alpha, 16 bits a channel
};

// A video file. It has no name before finish() (core/file.h, NewFile). It encodes on the calling
// thread, so the same pictures give the same bytes. Colours are labelled sRGB. Thread:
// thread-bound.
class VideoWriter {
public:
    // `size` in pixels; H.264 drops an odd last column or row, which its colour format cannot hold.
    // `frameRate` in Hz, 1..1000. `ticks`: numbers per frame; with several, a picture can begin
    // between two frames. Error: names the file that cannot be made, or the missing encoder.
    static Result<std::unique_ptr<VideoWriter>> open(const std::filesystem::path& file, glm::ivec2 size, double frameRate,
                                                     VideoKind kind = VideoKind::Recording, int ticks = 1);
    ~VideoWriter();

    // Shows `picture`, of the size given to open(), from frame `number` on. Numbers must rise. In a
    // gap the previous picture stays, and the last picture is shown for one frame. H.264 ignores
    // alpha; the others take it as straight (not premultiplied).
    Result<void> write(const RgbaImage& picture, std::int64_t number);
    Result<void> write(const Rgba16Image& picture, std::int64_t number);
    // Completes the file. Without it no file remains.
    Result<void> finish();

private:
    struct Impl;
    explicit VideoWriter(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace fantascope::app
