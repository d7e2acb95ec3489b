#pragma once

#include "core/result.h"
#include "media/image.h"

#include <glm/vec2.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace fantascope::drivers {

// Coding of a frame's pixels, named as by cameras.
enum class FrameCoding {
    Yuyv,   // 4:2:2, two pixels in four bytes
    Nv12,   // 4:2:0, a plane of luma, then one of colour at half the size
    Uyvy,   // as Yuyv, colour first
    Rgb24,  // three bytes per pixel
    Mjpg,   // one JPEG picture per frame
    Grey    // one byte per pixel
};

constexpr const char* nameOf(FrameCoding coding) {
    constexpr const char* kNames[] = {"YUYV", "NV12", "UYVY", "RGB24", "MJPG", "GREY"};
    return kNames[static_cast<int>(coding)];
}

// The weights of red, green and blue in luma.
enum class LumaWeights { Rec601, Rec709, Rec2020 };

struct FrameFormat {
    FrameCoding coding = FrameCoding::Yuyv;
    glm::ivec2 size{0};
    int stride = 0;          // bytes per row with padding, in both planes of Nv12; 0 for Mjpg
    bool fullRange = false;  // black is 0 and white 255; else 16 and 235, with colours in 16..240
    LumaWeights weights = LumaWeights::Rec601;
    friend bool operator==(const FrameFormat&, const FrameFormat&) = default;
};

// Bytes per row without padding; 0 for Mjpg.
int minStride(FrameCoding coding, int width);

// Decodes frames of one format. Thread: thread-bound.
class FrameDecoder {
public:
    // format.size is at least 2 x 2, and even for Yuyv, Uyvy and Nv12; the stride holds a row.
    explicit FrameDecoder(const FrameFormat& format);
    ~FrameDecoder();

    // Readable bytes required after a frame: libswscale reads whole blocks.
    static constexpr std::size_t kPadding = 256;

    // Decodes stored values into `picture`, which has format.size; alpha is 255. `frame` is
    // followed by kPadding bytes of any value. Error: the frame is too short or damaged, or a JPEG
    // has another size or pixels that cannot be converted; `picture` is then undefined.
    Result<void> decode(std::span<const std::uint8_t> frame, RgbaImage& picture);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace fantascope::drivers
