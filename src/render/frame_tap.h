#pragma once

#include "render/gpu/pixel_reader.h"

#include "device/display_sink.h"

#include "core/bounded_queue.h"
#include "core/clock.h"
#include "core/image.h"

#include <glm/vec2.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace fantascope::render {

// A frame as it went to a projector.
struct ShownFrame {
    std::size_t output = 0;  // index into the site's outputs
    Time showTime{};         // what was drawn
    Shown shown;             // when it becomes visible
    RgbaImage image;         // stored values, row 0 at the top, alpha 255
};

// One reader's view of an output's frames, in the order in which they are shown. A display may be handed a frame before it shows it;
// nobody sees it earlier here. Thread: next() from one thread; the rest is the tap's.
class FrameReader {
public:
    explicit FrameReader(const ShownFrame& blank) : waiting_(blank) {}

    // The next frame that is visible at `now` or was so before, each once; null if there is none. Valid until the next call.
    const ShownFrame* next(Time now);

private:
    friend class FrameTap;
    // One that is being read, and some more for a reader that the machine holds up; beyond that frames are left out.
    static constexpr std::size_t kMostWaiting = 4;
    BoundedQueue<ShownFrame, kMostWaiting> waiting_;
    bool reading_ = false;  // the queue's front
};

// Where shown frames leave the renderer, and the only place: the simulated site, recordings and z read here. One for each output.
//
// A frame: draw; capture(); the display's present(); publish(). The copy runs while the display presents, so that the render
// thread hardly waits for it. Without a reader nothing is copied. No allocation after readers have been added.
//
// Thread: the render thread, with the output's context current in capture(), publish() and the destructor; each reader belongs to
// one thread of its own.
class FrameTap {
public:
    // `size`: pixels of the output's display.
    FrameTap(std::size_t output, glm::ivec2 size);

    // A further reader; it lives as long as the tap. Call before the first frame.
    FrameReader& addReader();

    // After draw(): starts to copy what is in `framebuffer`, drawn for show time `showTime`.
    void capture(unsigned framebuffer, Time showTime);
    // After present(): hands the captured frame to every reader. When present() failed nothing was shown: leave it out.
    void publish(const Shown& shown);

private:
    std::optional<gpu::PixelReader> reader_;  // made with the first frame, since the display may come later than its readers
    Time captured_{};                         // the show time of what reader_ copies
    ShownFrame blank_;                        // what a reader holds before the first frame; of the display's size
    std::vector<std::unique_ptr<FrameReader>> readers_;
};

}  // namespace fantascope::render
