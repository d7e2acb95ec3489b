#include "render/frame_tap.h"

#include <utility>

namespace fantascope::render {

const ShownFrame* FrameReader::next(Time now) {
    if (std::exchange(reading_, false)) waiting_.drop();
    const ShownFrame* const oldest = waiting_.front();
    if (oldest == nullptr || oldest->shown.at > now) return nullptr;
    reading_ = true;
    return oldest;
}

FrameTap::FrameTap(std::size_t output, glm::ivec2 size) : blank_{output, Time{}, Shown{}, RgbaImage(size.x, size.y)} {}

FrameReader& FrameTap::addReader() { return *readers_.emplace_back(std::make_unique<FrameReader>(blank_)); }

void FrameTap::capture(unsigned framebuffer, Time showTime) {
    if (!reader_) reader_.emplace(glm::ivec2(blank_.image.width(), blank_.image.height()));
    reader_->start(framebuffer);
    captured_ = showTime;
}

void FrameTap::publish(const Shown& shown) {
    for (const auto& reader : readers_) {
        ShownFrame* const frame = reader->waiting_.space();
        if (frame == nullptr) continue;
        frame->showTime = captured_;
        frame->shown = shown;
        reader_->finish(frame->image);
        reader->waiting_.push();
    }
}

}  // namespace fantascope::render
