#pragma once

#include "app/base/video_writer.h"
#include "app/export/light_alpha.h"

#include "core/result.h"
#include "media/image.h"

#include <glm/vec2.hpp>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>

namespace fantascope::app {

// Frames for other programs, in the format of the target's name:
//   FILE.mp4  H.264, no alpha
//   FILE.mov  ProRes 4444
//   FILE.mkv  FFV1, 16 bits per channel, lossless
//   a folder  frame-000000.png, frame-000001.png, ...: 16 bits per channel with alpha, 8 without
// Alpha is that of withAlpha().
// Thread: thread-bound.
class FrameFile {
public:
    // `alpha`: default: Stored, or None for an MP4. Error: another ending, alpha for an MP4, a
    // folder that already has frames, or the target cannot be created.
    static Result<std::unique_ptr<FrameFile>> open(const std::filesystem::path& target, glm::ivec2 size, double frameRate,
                                                   std::optional<Alpha> alpha);

    Alpha alpha() const { return alpha_; }
    // Writes the next frame.
    Result<void> write(const RgbaImage& frame);
    // Completes the file, after at least one frame. Without it, a video is removed, but pictures
    // stay.
    Result<void> finish();

private:
    FrameFile(std::filesystem::path target, Alpha alpha) : target_(std::move(target)), alpha_(alpha) {}

    std::filesystem::path target_;
    Alpha alpha_;
    std::unique_ptr<VideoWriter> video_;  // null: a folder of pictures
    std::int64_t next_ = 0;
};

}  // namespace fantascope::app
