#pragma once

#include "core/clock.h"
#include "core/image.h"
#include "core/latest_value.h"

#include <cstdint>
#include <glm/vec2.hpp>
#include <memory>
#include <vector>

namespace fantascope::render {

// A frame as it was shown: stored sRGB values, row 0 at the top.
struct TappedFrame {
    RgbaImage image;
    Time showTime{};           // that the frame was drawn for
    std::int64_t refresh = 0;  // of its display, that it was drawn for
    int output = 0;            // index into the site's outputs
};

using FrameSlot = LatestValue<TappedFrame>;

// The one way to shown frames: the simulated site, recordings, thumbnails and the camera loop each read a slot of their own and never
// disturb the show; who reads too seldom misses frames. Nothing is read back while nobody listens.
// Thread: the render thread, but for the slots' reading ends; capture() with the display's context current.
class FrameTap {
public:
    // A further reader. Before the first frame. Lives as long as the tap.
    FrameSlot& addSlot();
    // Reads back what was drawn into `framebuffer`, to be published when it has been shown. No allocation once it has run with this size.
    void capture(unsigned framebuffer, glm::ivec2 size);
    // The captured frame was shown.
    void publish(Time showTime, std::int64_t refresh, int output);

private:
    std::vector<std::unique_ptr<FrameSlot>> slots_;
};

}  // namespace fantascope::render
