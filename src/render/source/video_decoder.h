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

// What a video file says of its frames, which are numbered in the order in which they are shown.
// Constant.
struct VideoContent {
    struct Frame {
        Time begins{};              // from the first frame's beginning
        std::int64_t stamp = 0;     // the same in the file's own time
        std::uint32_t decoded = 0;  // its place in the order of decoding
        std::uint32_t entry = 0;    // the frame, a keyframe, at which decoding has to begin for it
    };
    std::filesystem::path file;
    std::string codec;
    glm::ivec2 size{0};         // pixels
    Time length{};              // to the last frame's end; positive
    std::vector<Frame> frames;  // at least one

    // The frame that is seen at `position`, 0 <= position < length: the one with begins <= position
    // < the next one's begins.
    std::uint32_t frameAt(Time position) const;
};

// Decodes a video frame by frame, from any of them on. Damaged frames are left out, and those whose
// pixels cannot be converted. Thread: thread-bound; libav decodes on up to kThreads threads of its
// own, with the same result.
class VideoDecoder {
public:
    static constexpr int kThreads = 4;

    // Reads the file once through, for the moments of its frames. Error: names the file and says
    // what to do: no video in it, not decodable here, pixels that cannot be converted, truncated,
    // no frame, too large, high dynamic range, not upright.
    static Result<std::shared_ptr<const VideoContent>> examine(const std::filesystem::path& file);
    // Error: the file is not as it was.
    static Result<std::unique_ptr<VideoDecoder>> open(std::shared_ptr<const VideoContent> content);
    ~VideoDecoder();

    // The next frame of next() is the one at which decoding has to begin for `frame`, or where that
    // is damaged a later one.
    void seek(std::uint32_t frame);
    // Decodes one frame and returns its number, which rises until the next seek(); nothing after
    // the last one, or where the file cannot be read any further.
    std::optional<std::uint32_t> next();
    // The frame of the last next() as stored sRGB values, colours multiplied by alpha as
    // premultiply() does. `picture` has the content's size.
    void picture(RgbaImage& picture);
    // What went wrong first, ready to be logged; empty while nothing did.
    const std::string& damage() const;

private:
    struct Impl;
    explicit VideoDecoder(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace fantascope::render
