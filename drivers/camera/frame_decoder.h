#pragma once

#include "core/result.h"
#include "media/image.h"

#include <glm/vec2.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace fantascope::drivers {

// How the pixels of a frame are coded, by the names that cameras give them.
enum class FrameCoding {
    Yuyv,   // 4:2:2, two pixels in four bytes
    Nv12,   // 4:2:0, a plane of luma, then one of colour at half the size
    Uyvy,   // as Yuyv, colour first
    Rgb24,  // three bytes a pixel
    Mjpg,   // a JPEG picture each
    Grey    // one byte a pixel
};

constexpr const char* nameOf(FrameCoding coding) {
    constexpr const char* kNames[] = {"YUYV", "NV12", "UYVY", "RGB24", "MJPG", "GREY"};
    return kNames[static_cast<int>(coding)];
}

// Which weights luma was made of.
enum class LumaWeights { Rec601, Rec709, Rec2020 };

struct FrameFormat {
    FrameCoding coding = FrameCoding::Yuyv;
    glm::ivec2 size{0};
    int stride = 0;          // bytes from one row to the next, in both planes of Nv12; Mjpg has none
    bool fullRange = false;  // black is 0 and white 255; else 16 and 235, and colours lie within 16..240
    LumaWeights weights = LumaWeights::Rec601;
    friend bool operator==(const FrameFormat&, const FrameFormat&) = default;
};

// Bytes of a row without padding; Mjpg: 0.
int leastStride(FrameCoding coding, int width);

// Turns coded frames of one format into pictures. Thread: thread-bound.
class FrameDecoder {
public:
    // Needs format.size >= 2 x 2, even for Yuyv, Uyvy and Nv12, and a stride that holds a row.
    explicit FrameDecoder(const FrameFormat& format);
    ~FrameDecoder();

    // Bytes after a frame that may be read: libswscale reads whole blocks.
    static constexpr std::size_t kPadding = 256;

    // Writes stored values into `picture`, which has format.size; alpha 255. `frame` is followed by
    // kPadding bytes of any value. Error: the frame is too short, or damaged, or a JPEG of another
    // size or of pixels that cannot be converted; `picture` is then worth nothing.
    Result<void> decode(std::span<const std::uint8_t> frame, RgbaImage& picture);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace fantascope::drivers
