#include "render/frame_tap.h"

namespace fantascope::render {

FrameTap::FrameTap(std::size_t output, glm::ivec2 size) {
    newest_.output = output;
    newest_.image = RgbaImage(size.x, size.y);
}

LatestValue<ShownFrame>& FrameTap::addReader() {
    return *slots_.emplace_back(std::make_unique<LatestValue<ShownFrame>>(newest_));
}

void FrameTap::capture(unsigned framebuffer, Time showTime) {
    if (!reader_) reader_.emplace(glm::ivec2(newest_.image.width(), newest_.image.height()));
    reader_->start(framebuffer);
    captured_ = showTime;
}

void FrameTap::publish(const Shown& shown) {
    newest_.showTime = captured_;
    newest_.shown = shown;
    reader_->finish(newest_.image);
    for (const auto& slot : slots_) {
        slot->writable() = newest_;  // of the same size: copied in place
        slot->publish();
    }
}

}  // namespace fantascope::render
