#include "render/frame_tap.h"

#include "render/gpu/read_back.h"

namespace fantascope::render {

FrameSlot& FrameTap::addSlot() {
    slots_.push_back(std::make_unique<FrameSlot>());
    return *slots_.back();
}

void FrameTap::capture(unsigned framebuffer, glm::ivec2 size) {
    if (slots_.empty()) return;
    RgbaImage& first = slots_[0]->writable().image;
    gpu::readBack(framebuffer, size, first);
    for (std::size_t i = 1; i < slots_.size(); ++i) slots_[i]->writable().image = first;
}

void FrameTap::publish(Time showTime, std::int64_t refresh, int output) {
    for (const auto& slot : slots_) {
        TappedFrame& frame = slot->writable();
        frame.showTime = showTime;
        frame.refresh = refresh;
        frame.output = output;
        slot->publish();
    }
}

}  // namespace fantascope::render
