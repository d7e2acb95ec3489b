#pragma once

#include "render/gpu/pixel_reader.h"

#include "device/display_sink.h"

#include "core/bounded_queue.h"
#include "core/clock.h"
#include "core/image.h"
#include "core/latest_value.h"

#include <glm/vec2.hpp>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

namespace fantascope::render {

// A frame as it went to a projector.
struct ShownFrame {
    std::size_t output = 0;  // index into the site's outputs
    Time showTime{};         // what was drawn
    Shown shown;             // when it becomes visible
    RgbaImage image;         // stored values, row 0 at the top, alpha 255
};

// A frame's pixels where OpenGL put them, for all readers at once. Readers take their copy on their own threads; who holds the frame is
// counted by the render thread alone, since slots and queues give back to it what they held.
struct CapturedFrame {
    explicit CapturedFrame(glm::ivec2 size) : pixels(size) {}

    gpu::PixelReader pixels;
    std::int64_t number = 0;  // rises from frame to frame
    Time showTime{};
    Shown shown;
    std::uint32_t wanted = 0;  // by which readers: a bit for each
    int holders = 0;
};

// One reader's view of an output's frames. A display may be handed a frame before it shows it; nobody sees it earlier here.
// Thread: next() from one thread; the private rest is the render thread's.
class FrameReader {
public:
    virtual ~FrameReader() = default;

    // A frame that is visible at `now` or was so before, in the order in which they were shown and each once; null if there is none. Valid
    // until the next call.
    virtual const ShownFrame* next(Time now) = 0;

protected:
    // `blank`: of the output, its image of the display's size.
    explicit FrameReader(const ShownFrame& blank) : own_(blank) {}
    const ShownFrame* take(const CapturedFrame& frame);

private:
    friend class FrameTap;
    virtual bool wants(Time showTime) const = 0;
    virtual void promised(Time showTime) = 0;  // a frame that it wants will be given
    virtual void give(CapturedFrame& frame) = 0;

    ShownFrame own_;
};

// Every frame. For whoever must not miss one, such as a recording.
class FrameQueue final : public FrameReader {
public:
    explicit FrameQueue(const ShownFrame& blank) : FrameReader(blank) {}

    // The oldest frame that was not taken.
    const ShownFrame* next(Time now) override;

private:
    bool wants(Time) const override { return true; }
    void promised(Time) override {}
    void give(CapturedFrame& frame) override;

    // For a reader that the machine holds up; beyond that frames are left out.
    static constexpr std::size_t kMostWaiting = 4;
    BoundedQueue<CapturedFrame*, kMostWaiting> waiting_;
};

// The newest frame, for whoever looks at the show as it is now. One that does not look costs nothing but this slot.
class NewestFrame final : public FrameReader {
public:
    // `rate`: Hz, how many frames it is given at most; 0 for those alone that are asked for, infinity for every frame.
    NewestFrame(const ShownFrame& blank, double rate);

    // The newest visible frame; what it took the place of is gone.
    const ShownFrame* next(Time now) override;
    // Wants one frame besides: the first that is drawn for `showTime` or later. Readers of several outputs that ask for the same moment, far
    // enough ahead that no output has drawn it, get frames of one moment. Thread: that of next().
    void ask(Time showTime) { asked_ = showTime.count(); }

private:
    bool wants(Time showTime) const override;
    void promised(Time showTime) override;
    void give(CapturedFrame& frame) override;

    // A display holds one frame at most, so when the newest one is not visible yet, the one before it is.
    struct Newest {
        CapturedFrame *frame = nullptr, *before = nullptr;
    };
    static constexpr Time::rep kNothing = Time::max().count();

    Time interval_{}, due_ = Time::min();
    std::atomic<Time::rep> asked_ = kNothing;
    LatestValue<Newest> slot_;
    CapturedFrame* given_ = nullptr;  // the newest
    std::int64_t taken_ = -1;         // its number
};

// Where shown frames leave the renderer, and the only place. One for each output. Who reads what:
//
//   a recording                         every frame                   addQueue(): a video with gaps would be a wrong one
//   the simulated site's projectors     the newest                    addNewest(infinity)
//   a prediction of the camera's view   the newest                    addNewest(infinity)
//   a picture when the operator asks    one of a moment to come       addNewest(0), ask()
//   small pictures for a console        the newest, a few a second    addNewest(rate), then resizedLight() of core/image.h
//   pictures that nobody is shown       each, once it is drawn        addNewest(infinity), finish()
//
// A frame: draw; capture(); the display's present(); publish(). A frame is copied from the GPU once if any reader wants it, and not at all
// otherwise. The render thread queues that copy and passes on where it is; readers take it from there on their own threads. It never waits
// for a copy: one that the display's present() has not waited for either is handed out with a later frame, and while kMostUnderWay are
// under way further ones are left out. No allocation after prepare().
//
// Thread: the render thread, with the output's context current in capture(), publish(), prepare(), finish() and the destructor; each reader
// belongs to one thread of its own.
class FrameTap {
public:
    // `size`: pixels of the output's display.
    FrameTap(std::size_t output, glm::ivec2 size);

    // A further reader; it lives as long as the tap. Before the first frame; at most 32.
    FrameQueue& addQueue();
    NewestFrame& addNewest(double rate);

    // Makes room for all that its readers can hold. Otherwise it is made when a frame needs it.
    void prepare();
    // After draw(): starts to copy what is in `framebuffer`, drawn for show time `showTime`, if a reader wants it.
    void capture(unsigned framebuffer, Time showTime);
    // After present(): the captured frame was shown. When present() failed nothing was: leave it out.
    void publish(const Shown& shown);
    // Waits for all copies and hands them out: no frame is to come, or this one is needed now.
    void finish();

private:
    static constexpr std::size_t kMostUnderWay = 3, kMostReaders = 32;
    // In what a reader may hold the whole time, and in what waits for it, are two frames each; a queue holds four.
    static constexpr std::size_t kMostHeld = 4;

    template <class Reader, class... Arguments>
    Reader& add(Arguments... arguments);
    CapturedFrame& unused();
    void handOut(CapturedFrame& frame);

    const ShownFrame blank_;  // what a reader has before the first frame; of the display's size
    std::vector<std::unique_ptr<FrameReader>> readers_;
    std::deque<CapturedFrame> frames_;   // made once the display is there, which may come later than its readers
    CapturedFrame* captured_ = nullptr;  // the frame that is being made, where somebody wants it
    std::int64_t captures_ = 0;
    BoundedQueue<CapturedFrame*, kMostUnderWay> underWay_;  // shown, and perhaps not copied yet
};

}  // namespace fantascope::render
