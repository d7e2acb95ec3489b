#include "app/recording.h"

#include "app/contact_sheet.h"

#include "core/file.h"

#include <fmt/format.h>

#include <algorithm>

namespace fantascope::app {

namespace fs = std::filesystem;

namespace {

// FNV-1a, 64 bits, over the stored bytes: two runs that show the same give the same lines.
std::uint64_t hashOf(const RgbaImage& picture) {
    std::uint64_t hash = 0xcbf29ce484222325u;
    for (const Rgba8& pixel : picture.pixels())
        for (const std::uint8_t byte : {pixel.r, pixel.g, pixel.b}) hash = (hash ^ byte) * 0x100000001b3u;
    return hash;
}

}  // namespace

Result<std::unique_ptr<Recording>> Recording::open(const fs::path& target, std::vector<Output> outputs) {
    std::unique_ptr<Recording> recording(new Recording(target, std::move(outputs)));
    if (target.has_extension() && !recording->sideBySide())
        return Error(
            fmt::format("{}: a recording goes into a folder, or into one video file that ends in .mp4", target.string()));
    if (recording->sideBySide()) {
        glm::ivec2 size(0);
        for (const Output& output : recording->outputs_) size = {size.x + output.size.x, std::max(size.y, output.size.y)};
        recording->tiled_ = RgbaImage(size.x, size.y);
        if (!recording->outputs_.empty())
            recording->videos_.push_back({TRY(VideoWriter::open(target, size, recording->outputs_[0].frameRate))});
    } else {
        for (const Output& output : recording->outputs_)
            recording->videos_.push_back(
                {TRY(VideoWriter::open(target / (output.name + ".mp4"), output.size, output.frameRate))});
    }
    return recording;
}

Result<void> Recording::frame(std::size_t output, const RgbaImage& picture, std::int64_t refresh, Time showTime) {
    Video& video = videos_[sideBySide() ? 0 : output];
    if (!sideBySide() && refresh <= video.lastRefresh) return {};
    if (video.firstRefresh < 0) video.firstRefresh = refresh;
    fmt::format_to(std::back_inserter(frames_), "{},{:.6f},{},{:016x}\n", refresh, seconds(showTime), outputs_[output].name,
                   hashOf(picture));
    if (!sideBySide()) {
        video.lastRefresh = refresh;
        return video.writer->write(picture, refresh - video.firstRefresh);
    }
    int left = 0;
    for (std::size_t i = 0; i < output; ++i) left += outputs_[i].size.x;
    for (int y = 0; y < picture.height(); ++y) std::copy_n(picture.row(y).begin(), picture.width(), tiled_.row(y).begin() + left);
    // Written with the last output's frame of a refresh.
    if (output + 1 < outputs_.size() || refresh <= video.lastRefresh) return {};
    video.lastRefresh = refresh;
    return video.writer->write(tiled_, refresh - video.firstRefresh);
}

void Recording::lighting(Time showTime, int universe, std::span<const std::uint8_t> slots) {
    // The dark end of a universe says nothing.
    while (!slots.empty() && slots.back() == 0) slots = slots.first(slots.size() - 1);
    fmt::format_to(std::back_inserter(dmx_), "{:.6f},{},{}\n", seconds(showTime), universe, fmt::join(slots, " "));
}

void Recording::relays(Time showTime, const std::string& bank, const std::vector<bool>& states) {
    const std::lock_guard lock(relaysMutex_);
    relays_ += fmt::format("{:.6f},{},", seconds(showTime), bank);
    for (const bool on : states) relays_ += on ? '1' : '0';
    relays_ += '\n';
}

void Recording::cue(int index, const std::string& label, const RgbaImage& picture) { cues_[index] = {label, picture}; }

Result<void> Recording::finish() {
    for (Video& video : videos_)
        if (video.lastRefresh >= 0) TRY(video.writer->finish());
    if (sideBySide()) return {};
    TRY(writeFile(target_ / "frames.csv", frames_));
    TRY(writeFile(target_ / "dmx.csv", dmx_));
    TRY(writeFile(target_ / "relays.csv", relays_));
    std::vector<LabelledPicture> pictures;
    for (const auto& [index, labelled] : cues_) pictures.push_back({labelled.first, labelled.second});
    if (!pictures.empty()) TRY(writePng(target_ / "contact-sheet.png", contactSheet(pictures)));
    return {};
}

}  // namespace fantascope::app
