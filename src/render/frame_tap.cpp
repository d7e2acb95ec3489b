#include "render/frame_tap.h"

namespace fantascope::render {

FrameTap::FrameTap(std::size_t output, glm::ivec2 size) : blank_{output, Time{}, Shown{}, RgbaImage(size.x, size.y)} {}

LatestValue<ShownFrame>& FrameTap::addReader() {
    return *slots_.emplace_back(std::make_unique<LatestValue<ShownFrame>>(blank_));
}

void FrameTap::capture(unsigned framebuffer, Time showTime) {
    if (!reader_) reader_.emplace(glm::ivec2(blank_.image.width(), blank_.image.height()));
    reader_->start(framebuffer);
    captured_ = showTime;
}

void FrameTap::publish(const Shown& shown) {
    for (const auto& slot : slots_) {
        ShownFrame& frame = slot->writable();
        frame.showTime = captured_;
        frame.shown = shown;
        reader_->finish(frame.image);
        slot->publish();
    }
}

}  // namespace fantascope::render
