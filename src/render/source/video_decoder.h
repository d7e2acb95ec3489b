#pragma once

#include "core/clock.h"
#include "core/result.h"
#include "media/image.h"

#include <glm/vec2.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace fantascope::render {

// A video file's frames, numbered in the order in which they are shown. Constant.
struct VideoContent {
    struct Frame {
        Time begins{};              // since the first frame's beginning
        std::int64_t stamp = 0;     // the same in the file's time base
        std::uint32_t decoded = 0;  // its index in decoding order
        std::uint32_t entry = 0;    // the keyframe at which decoding must begin to reach it
    };
    std::filesystem::path file;
    std::string codec;
    glm::ivec2 size{0};         // pixels
    Time length{};              // until the last frame's end; positive
    std::vector<Frame> frames;  // at least one

    // The frame that is shown at `position`, 0 <= position < length: the last one that begins no
    // later.
    std::uint32_t frameAt(Time position) const;
};

// Decodes a video frame by frame, starting at any frame. Skips damaged frames and those whose
// pixels cannot be converted. Thread: thread-bound; libav decodes on up to kThreads threads of its
// own, which does not affect the result.
class VideoDecoder {
public:
    static constexpr int kThreads = 4;

    // Reads the whole file once for the times of its frames. Error: names the file and says what to
    // do: it has no video or no frame, is truncated, too large or not upright, has a high dynamic
    // range, cannot be decoded here, or its pixels cannot be converted.
    static Result<std::shared_ptr<const VideoContent>> examine(const std::filesystem::path& file);
    // Error: the file has changed since examine().
    static Result<std::unique_ptr<VideoDecoder>> open(std::shared_ptr<const VideoContent> content);
    ~VideoDecoder();

    // Goes to the keyframe at which decoding must begin to reach `frame`: next() decodes that one,
    // or a later one if it is damaged.
    void seek(std::uint32_t frame);
    // Decodes one frame and returns its number, which rises until the next seek(). Returns nothing
    // after the last frame, or if the file cannot be read further.
    std::optional<std::uint32_t> next();
    // Converts the frame of the last next() to stored sRGB values, colours multiplied by alpha as
    // by premultiply(). `picture` has the content's size.
    void picture(RgbaImage& picture);
    // The first damage that was found, as a line for the log; empty if none was.
    const std::string& damage() const;

private:
    struct Impl;
    explicit VideoDecoder(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace fantascope::render
