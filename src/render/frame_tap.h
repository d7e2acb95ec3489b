#pragma once

#include "render/gpu/pixel_reader.h"

#include "device/display_sink.h"

#include "core/bounded_queue.h"
#include "core/clock.h"
#include "core/latest_value.h"
#include "core/result.h"
#include "media/image.h"

#include <glm/vec2.hpp>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

namespace fantascope::render {

// A frame as it went to a projector.
struct ShownFrame {
    std::size_t output = 0;  // index into the site's outputs
    Time showTime{};         // what was drawn
    Shown shown;             // when it becomes visible
    RgbaImage image;         // stored values, row 0 at the top, alpha 255
};

// A frame's pixels where OpenGL put them, for all readers at once. Readers take their copy on their
// own threads; who holds the frame is counted by the render thread alone, since slots and queues
// give back to it what they held.
struct CapturedFrame {
    explicit CapturedFrame(gpu::PixelReader reader) : pixels(std::move(reader)) {}

    gpu::PixelReader pixels;
    std::int64_t number = 0;  // rises from frame to frame
    Time showTime{};
    Shown shown;
    std::uint32_t wanted = 0;  // by which readers: a bit for each
    int holders = 0;
};

// One reader's view of an output's frames. A display may be handed a frame before it shows it;
// nobody sees it earlier here. When the output's context is lost, frames that were not taken yet
// are lost with it. Thread: next() from one thread; the private rest is the render thread's.
class FrameReader {
public:
    virtual ~FrameReader() = default;

    // A frame that is visible at `now` or was so before, in the order in which they were shown and
    // each once; null if there is none. Valid until the next call.
    const ShownFrame* next(Time now) {
        const std::lock_guard lock(taking_);
        return newer(now);
    }

protected:
    // `blank`: of the output, its image of the display's size.
    explicit FrameReader(const ShownFrame& blank) : own_(blank) {}
    const ShownFrame* take(const CapturedFrame& frame);

    std::mutex taking_;  // held while a frame is copied; the render thread takes it when a context is lost

private:
    friend class FrameTap;
    virtual const ShownFrame* newer(Time now) = 0;
    // Lets go of all frames that it was given. While taking_ is held.
    virtual void forget() = 0;
    virtual bool wants(Time showTime) const = 0;
    virtual void promised(Time showTime) = 0;  // a frame that it wants will be given
    virtual void give(CapturedFrame& frame) = 0;
    virtual void miss() {}  // a frame that it wants was shown, and could not be copied
    virtual std::size_t mostHeld() const = 0;

    ShownFrame own_;
};

// Every frame, while there is room for those that wait. For whoever must not miss one, such as a
// recording.
class FrameQueue final : public FrameReader {
public:
    // `depth`: how many frames may wait; beyond that they are left out and counted.
    FrameQueue(const ShownFrame& blank, std::size_t depth) : FrameReader(blank), waiting_(depth) {}

    // When the oldest frame that was not taken became visible; nothing if there is none that
    // next(now) gives. Thread: that of next().
    std::optional<Time> nextAt(Time now);
    // How many frames were shown and left out, or lost with their context. Thread-safe.
    std::int64_t missed() const { return missed_; }

private:
    // The oldest frame that was not taken.
    const ShownFrame* newer(Time now) override;
    void forget() override;
    bool wants(Time) const override { return true; }
    void promised(Time) override {}
    void give(CapturedFrame& frame) override;
    void miss() override { ++missed_; }
    std::size_t mostHeld() const override { return waiting_.size(); }
    CapturedFrame* oldest(Time now) const;

    // A ring: the reader takes from `taken_` to `given_`, the render thread gives back what it held
    // up to `taken_`.
    std::vector<CapturedFrame*> waiting_;
    std::atomic<std::size_t> given_ = 0, taken_ = 0;
    std::size_t released_ = 0;
    std::atomic<std::int64_t> missed_ = 0;
};

// The newest frame, for whoever looks at the show as it is now. One that does not look costs
// nothing but this slot.
class NewestFrame final : public FrameReader {
public:
    // `rate`: Hz, how many frames it is given at most; 0 for those alone that are asked for,
    // infinity for every frame.
    NewestFrame(const ShownFrame& blank, double rate);

    // Wants one frame besides: the first that is drawn for `showTime` or later. Readers of several
    // outputs that ask for the same moment, far enough ahead that no output has drawn it, get
    // frames of one moment. Thread: that of next().
    void ask(Time showTime) { asked_ = showTime.count(); }

private:
    // The newest visible frame; what it took the place of is gone.
    const ShownFrame* newer(Time now) override;
    void forget() override;
    bool wants(Time showTime) const override;
    void promised(Time showTime) override;
    void give(CapturedFrame& frame) override;
    // Two in the slot that is read, and two in what waits for it.
    std::size_t mostHeld() const override { return 4; }

    // A display holds one frame at most, so when the newest one is not visible yet, the one before
    // it is.
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
// A frame: draw; capture(); the display's present(); publish(). A frame is copied from the GPU once
// if any reader wants it, and not at all otherwise. The render thread queues that copy and passes
// on where it is; readers take it from there on their own threads. It never waits for a copy: one
// that the display's present() has not waited for either is handed out with a later frame, and
// while kMostUnderWay are under way further ones are left out; a queue counts them. No allocation
// after prepare().
//
// Thread: the render thread, with the output's context current in capture(), publish(), prepare(),
// finish() and the destructor; after forget() the destructor needs no context. Each reader belongs
// to one thread of its own.
class FrameTap {
public:
    // `size`: pixels of the output's display.
    FrameTap(std::size_t output, glm::ivec2 size);

    // A further reader; it lives as long as the tap. Before the first frame; at most 32.
    FrameQueue& addQueue(std::size_t depth = 4);
    NewestFrame& addNewest(double rate);

    // Makes room for all that its readers can hold. Otherwise it is made when a frame needs it.
    // Error: OpenGL has no memory left.
    Result<void> prepare();
    // The context is lost: forgets, without OpenGL calls, every frame that no reader has taken.
    // prepare() makes room in the next context.
    void forget();
    // After draw(): starts to copy what is in `framebuffer`, drawn for show time `showTime`, if a
    // reader wants it.
    void capture(unsigned framebuffer, Time showTime);
    // After present(): the captured frame was shown. When present() failed nothing was: leave it
    // out.
    void publish(const Shown& shown);
    // Waits for all copies and hands them out: no frame is to come, or this one is needed now.
    void finish();

private:
    static constexpr std::size_t kMostUnderWay = 3, kMostReaders = 32;
    template <class Reader, class... Arguments>
    Reader& add(Arguments... arguments);
    std::size_t mostHeld() const;
    Result<void> addFrame();
    CapturedFrame* unused();  // null: OpenGL has no memory left
    void handOut(CapturedFrame& frame);

    const ShownFrame blank_;  // what a reader has before the first frame; of the display's size
    std::vector<std::unique_ptr<FrameReader>> readers_;
    std::deque<CapturedFrame> frames_;   // made once the display is there, which may come later than its readers
    CapturedFrame* captured_ = nullptr;  // the frame that is being made, where somebody wants it
    std::uint32_t missing_ = 0;          // by whom it is wanted, where it cannot be copied
    std::int64_t captures_ = 0;
    BoundedQueue<CapturedFrame*, kMostUnderWay> underWay_;  // shown, and perhaps not copied yet
};

}  // namespace fantascope::render
