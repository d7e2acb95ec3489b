#include "app/live/recording.h"

#include "app/base/contact_sheet.h"

#include "core/hash.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace fantascope::app {

namespace fs = std::filesystem;

namespace {

// Ticks of a video's clock per refresh of its output. There are several, because a display may
// refresh a little faster than the site file says.
constexpr int kTicks = 4;

// Over the stored bytes. Two runs that show the same pictures give the same hashes.
std::uint64_t hashOf(const RgbaImage& picture) {
    std::uint64_t hash = fnv1a("");
    for (const Rgba8& pixel : picture.pixels()) {
        const char bytes[] = {static_cast<char>(pixel.r), static_cast<char>(pixel.g), static_cast<char>(pixel.b)};
        hash = fnv1a({bytes, sizeof bytes}, hash);
    }
    return hash;
}

}  // namespace

Recording::Recording(fs::path target, std::vector<Output> outputs)
    : target_(std::move(target)),
      outputs_(std::move(outputs)),
      frames_(outputs_.size()),
      newestLine_(outputs_.size(), Time::min()),
      framesTable_(target_ / "frames.csv", "refresh,show_time_s,output,fnv1a64\n"),
      dmx_(target_ / "dmx.csv", "show_time_s,universe,slots\n"),
      relays_(target_ / "relays.csv", "show_time_s,bank,states\n") {}

Result<std::unique_ptr<Recording>> Recording::ofSite(const fs::path& target, const show::Site& site) {
    if (target.empty()) return std::unique_ptr<Recording>();
    std::vector<Output> outputs;
    for (const show::Output& output : site.outputs) outputs.push_back({output.name, output.size(), output.refreshRate});
    return open(target, std::move(outputs));
}

Result<std::unique_ptr<Recording>> Recording::open(const fs::path& target, std::vector<Output> outputs) {
    std::unique_ptr<Recording> recording(new Recording(target, std::move(outputs)));
    if (target.has_extension() && !recording->sideBySide())
        return Error(
            fmt::format("{}: a recording goes into a folder, or into one video file that ends in .mp4", target.string()));
    const auto add = [&](const fs::path& file, const glm::ivec2& size, double rate) -> Result<void> {
        recording->videos_.push_back({TRY(VideoWriter::open(file, size, rate, VideoKind::Recording, kTicks)), -1, {}});
        return {};
    };
    if (recording->sideBySide()) {
        glm::ivec2 size(0);
        for (const Output& output : recording->outputs_) size = {size.x + output.size.x, std::max(size.y, output.size.y)};
        recording->tiled_ = RgbaImage(size.x, size.y);
        if (!recording->outputs_.empty()) TRY(add(target, size, recording->outputs_[0].frameRate));
    } else {
        for (const Output& output : recording->outputs_) TRY(add(target / (output.name + ".mp4"), output.size, output.frameRate));
    }
    return recording;
}

std::vector<std::vector<std::size_t>> Recording::videos() const {
    std::vector<std::vector<std::size_t>> videos(videos_.size());
    for (std::size_t output = 0; output < outputs_.size(); ++output) videos[sideBySide() ? 0 : output].push_back(output);
    return videos;
}

// Writes a picture. If that fails, the video is given up at once, because its bytes may be what
// fills the disk.
Result<void> Recording::write(Video& video, const RgbaImage& picture, Time at) {
    const double rate = outputs_[sideBySide() ? 0 : static_cast<std::size_t>(&video - videos_.data())].frameRate;
    video.number = std::max<std::int64_t>(video.number + 1, std::llround(seconds(at - runStart_) * rate * kTicks));
    Result<void> written = video.writer->write(picture, video.number);
    if (!written) video.writer.reset();
    return written;
}

Result<void> Recording::frame(std::size_t output, const RgbaImage& picture, const Shown& shown, Time showTime) {
    Video& video = videos_[sideBySide() ? 0 : output];
    if (!video.writer) return {};
    if (!sideBySide()) {
        TRY(write(video, picture, shown.at));
        addLine({showTime, output, frames_[output].count, shown.refresh, hashOf(picture)});
    } else {
        // Frames that become visible within half a refresh period count as simultaneous. A faster
        // output may have its next frame within that time.
        const bool together = video.tiled && shown.at - *video.tiled <= tickTime(1, 2 * outputs_[0].frameRate);
        if (!together || frames_[output].tiled) TRY(writeTiled());
        if (!video.tiled) video.tiled = shown.at;
        frames_[output].tiled = true;
        int left = 0;
        for (std::size_t i = 0; i < output; ++i) left += outputs_[i].size.x;
        for (int y = 0; y < picture.height(); ++y)
            std::copy_n(picture.row(y).begin(), picture.width(), tiled_.row(y).begin() + left);
    }
    ++frames_[output].count;
    return {};
}

Result<void> Recording::writeTiled() {
    if (videos_.empty() || !videos_[0].tiled || !videos_[0].writer) return {};
    for (Frames& frames : frames_) frames.tiled = false;
    return write(videos_[0], tiled_, *std::exchange(videos_[0].tiled, std::nullopt));
}

void Recording::lighting(Time showTime, int universe, std::span<const std::uint8_t> slots) {
    // Trailing slots at 0 are left out.
    while (!slots.empty() && slots.back() == 0) slots = slots.first(slots.size() - 1);
    if (!sideBySide()) dmx_.add(fmt::format("{:.6f},{},{}\n", seconds(showTime), universe, fmt::join(slots, " ")));
}

void Recording::relays(Time showTime, const std::string& bank, const std::vector<bool>& states) {
    if (sideBySide()) return;
    std::string line = fmt::format("{:.6f},{},", seconds(showTime), bank);
    for (const bool on : states) line += on ? '1' : '0';
    relays_.add(line + '\n');
}

void Recording::cue(int index, const std::string& label, const RgbaImage& picture) { cues_[index] = {label, picture}; }

// Keeps the lines in the order of show time: a line waits until no output can have an older one.
void Recording::addLine(const Line& line) {
    const std::lock_guard lock(linesMutex_);
    lines_.insert(line);
    newestLine_[line.output] = line.showTime;
    const Time certain = *std::ranges::min_element(newestLine_);
    while (!lines_.empty() && (lines_.size() > kMostLines || lines_.begin()->showTime < certain)) putOldestLine();
}

void Recording::putOldestLine() {
    const Line& line = *lines_.begin();
    framesTable_.add(
        fmt::format("{},{:.6f},{},{:016x}\n", line.refresh, seconds(line.showTime), outputs_[line.output].name, line.hash));
    lines_.erase(lines_.begin());
}

std::vector<Error> Recording::writeTables() {
    std::vector<Error> errors;
    if (!sideBySide())
        for (TableFile* const table : {&framesTable_, &dmx_, &relays_})
            if (const auto written = table->write(); !written) errors.push_back(written.error());
    return errors;
}

Result<void> Recording::finish() {
    std::string refusals;
    const auto note = [&](const Result<void>& done) {
        if (!done) refusals += (refusals.empty() ? "" : "; ") + done.error().message();
        return done.has_value();
    };
    if (sideBySide()) note(writeTiled());
    const auto shown = videos();
    for (std::size_t i = 0; i < videos_.size(); ++i) {
        Video& video = videos_[i];
        const bool isLeft = video.writer && (video.number < 0 || note(video.writer->finish()));
        video.writer.reset();
        if (!isLeft)
            for (const std::size_t output : shown[i]) frames_[output].count = 0;
    }
    if (!sideBySide()) {
        {
            const std::lock_guard lock(linesMutex_);
            while (!lines_.empty()) putOldestLine();
        }
        for (TableFile* const table : {&framesTable_, &dmx_, &relays_}) note(table->finish());
        std::vector<LabelledPicture> pictures;
        for (const auto& [index, labelled] : cues_) {
            note(writePng(target_ / fmt::format("camera-{}.png", index + 1), labelled.second));
            pictures.push_back({labelled.first, labelled.second});
        }
        if (!pictures.empty()) note(writePng(target_ / "contact-sheet.png", contactSheet(pictures)));
    }
    if (!refusals.empty()) return Error(refusals);
    return {};
}

}  // namespace fantascope::app
