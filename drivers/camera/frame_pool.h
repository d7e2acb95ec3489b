#pragma once

#include "device/camera_source.h"

#include <glm/vec2.hpp>

#include <memory>
#include <mutex>
#include <vector>

namespace fantascope::drivers {

// A pool that reuses the memory of frames that nobody holds, so a steady stream allocates no
// pictures. Thread: take() from one thread; frames may be held and released on any, even after the
// pool is destroyed.
class FramePool {
public:
    // A frame of this size; its picture has old contents.
    std::shared_ptr<CameraFrame> take(glm::ivec2 size) {
        std::unique_ptr<CameraFrame> frame;
        {
            const std::lock_guard lock(shelf_->mutex);
            if (!shelf_->frames.empty()) {
                frame = std::move(shelf_->frames.back());
                shelf_->frames.pop_back();
            }
        }
        if (!frame) frame = std::make_unique<CameraFrame>();
        if (glm::ivec2(frame->image.width(), frame->image.height()) != size) frame->image = RgbaImage(size.x, size.y);
        return {frame.release(), [shelf = shelf_](CameraFrame* used) {
                    std::unique_ptr<CameraFrame> back(used);
                    const std::lock_guard lock(shelf->mutex);
                    if (shelf->frames.size() < kMaxKept) shelf->frames.push_back(std::move(back));
                }};
    }

private:
    static constexpr std::size_t kMaxKept = 4;  // frames; a reader that holds more at once allocates again
    struct Shelf {
        std::mutex mutex;
        std::vector<std::unique_ptr<CameraFrame>> frames;
    };
    std::shared_ptr<Shelf> shelf_ = std::make_shared<Shelf>();
};

}  // namespace fantascope::drivers
