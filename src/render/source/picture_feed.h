#pragma once

#include "core/latest_value.h"
#include "media/image.h"

#include <glm/vec2.hpp>

#include <memory>
#include <mutex>
#include <vector>

namespace fantascope::render {

// Pictures from another part of the program, such as a camera. Each output that shows them takes
// the newest. Thread: publish() from one thread, the readers from another.
class PictureFeed {
public:
    using Picture = std::shared_ptr<const RgbaImage>;
    using Slot = LatestValue<Picture>;  // the writer frees pictures, so that drawing never does

    // `size`: of its pictures, pixels.
    explicit PictureFeed(glm::ivec2 size) : size_(size) {}

    glm::ivec2 size() const { return size_; }
    // Stored sRGB values, alpha 255. A picture of another size is ignored.
    void publish(const Picture& picture) {
        if (glm::ivec2(picture->width(), picture->height()) != size_) return;
        const std::lock_guard lock(mutex_);
        for (const auto& held : slots_)
            if (const auto slot = held.lock()) {
                slot->writable() = picture;
                slot->publish();
            }
    }
    // Adds a reader of the pictures published from now on.
    std::shared_ptr<Slot> addReader() {
        const std::lock_guard lock(mutex_);
        std::erase_if(slots_, [](const auto& slot) { return slot.expired(); });
        auto added = std::make_shared<Slot>();
        slots_.push_back(added);
        return added;
    }

private:
    const glm::ivec2 size_;
    std::mutex mutex_;  // between publish() and addReader()
    std::vector<std::weak_ptr<Slot>> slots_;
};

}  // namespace fantascope::render
