#include "app/export/frame_file.h"

#include <fmt/format.h>

#include <utility>

namespace fantascope::app {

namespace fs = std::filesystem;

namespace {

constexpr std::pair<const char*, VideoKind> kVideos[] = {
    {".mp4", VideoKind::Film}, {".mov", VideoKind::ProRes4444}, {".mkv", VideoKind::Lossless}};

fs::path pictureOf(const fs::path& folder, std::int64_t number) { return folder / fmt::format("frame-{:06}.png", number); }

}  // namespace

Result<std::unique_ptr<FrameFile>> FrameFile::open(const fs::path& target, glm::ivec2 size, double frameRate,
                                                   std::optional<Alpha> alpha) {
    const bool opaque = target.extension() == ".mp4";
    if (opaque && alpha.value_or(Alpha::None) != Alpha::None)
        return Error(fmt::format("{}: an MP4 has no alpha; write a folder of pictures, FILE.mov or FILE.mkv", target.string()));
    std::unique_ptr<FrameFile> file(new FrameFile(target, alpha.value_or(opaque ? Alpha::None : Alpha::Stored)));
    for (const auto& [ending, kind] : kVideos)
        if (target.extension() == ending) {
            file->video_ = TRY(VideoWriter::open(target, size, frameRate, kind));
            return file;
        }
    if (target.has_extension())
        return Error(fmt::format(
            "{}: frames are written to FILE.mp4, FILE.mov or FILE.mkv, or as PNG pictures to a folder, whose name has no "
            "ending",
            target.string()));
    std::error_code failure;
    fs::create_directories(target, failure);
    if (failure) return Error(fmt::format("{}: the folder cannot be created: {}", target.string(), failure.message()));
    // The last frames of a longer previous export would be left and look like part of this one.
    if (fs::exists(pictureOf(target, 0), failure))
        return Error(fmt::format("{}: already has frames in it; name another folder, or remove them", target.string()));
    return file;
}

Result<void> FrameFile::write(const RgbaImage& frame) {
    const std::int64_t number = next_++;
    if (alpha_ == Alpha::None) return video_ ? video_->write(frame, number) : writePng(pictureOf(target_, number), frame);
    const Rgba16Image light = withAlpha(frame, alpha_);
    return video_ ? video_->write(light, number) : writePng(pictureOf(target_, number), light);
}

Result<void> FrameFile::finish() {
    if (video_) return video_->finish();
    return {};
}

}  // namespace fantascope::app
