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

// A frame as it was sent to a projector.
struct ShownFrame {
    std::size_t output = 0;  // index into the site's outputs
    Time showTime{};         // the show time that was drawn
    Shown shown;             // when it becomes visible
    RgbaImage image;         // stored values, row 0 at the top, alpha 255
};

// A frame's pixels where OpenGL put them, shared by all readers. Readers copy them on their own
// threads. Only the render thread counts holders, since slots and queues return frames to it.
struct CapturedFrame {
    explicit CapturedFrame(gpu::PixelReader reader) : pixels(std::move(reader)) {}

    gpu::PixelReader pixels;
    std::int64_t number = 0;  // sequence number, rises from frame to frame
    Time showTime{};
    Shown shown;
    std::uint32_t wanted = 0;  // by which readers, one bit each
    int holders = 0;
};

// One reader's view of an output's frames. A display may receive a frame before it shows it; a
// reader never sees it earlier. Frames that were not taken are lost with the output's context.
// Thread: next() from one thread; the private methods from the render thread.
class FrameReader {
public:
    virtual ~FrameReader() = default;

    // Returns a frame that is or was visible at `now`, or null if there is none. Frames come in the
    // order in which they were shown, each once. Valid until the next call.
    const ShownFrame* next(Time now) {
        const std::lock_guard lock(taking_);
        return newer(now);
    }

protected:
    // `blank`: its output is set, and its image has the display's size.
    explicit FrameReader(const ShownFrame& blank) : own_(blank) {}
    const ShownFrame* take(const CapturedFrame& frame);

    std::mutex taking_;  // held while a frame is copied, and by forget()

private:
    friend class FrameTap;
    virtual const ShownFrame* newer(Time now) = 0;
    // Drops all frames that it was given. The caller holds taking_.
    virtual void forget() = 0;
    virtual bool wants(Time showTime) const = 0;
    virtual void promised(Time showTime) = 0;  // a frame that it wants, of this time, will be given
    virtual void give(CapturedFrame& frame) = 0;
    virtual void miss() {}  // a frame that it wants was shown but could not be copied
    virtual std::size_t maxHeld() const = 0;

    ShownFrame own_;
};

// Gives every frame as long as the queue has room. For a reader that must not miss one, such as a
// recording.
class FrameQueue final : public FrameReader {
public:
    // `depth`: how many frames may wait; further ones are dropped and counted.
    FrameQueue(const ShownFrame& blank, std::size_t depth) : FrameReader(blank), waiting_(depth) {}

    // When the frame that next(now) would give became visible; nothing if it would give none.
    // Thread: that of next().
    std::optional<Time> nextAt(Time now);
    // How many shown frames were dropped or lost with their context. Thread-safe.
    std::int64_t missed() const { return missed_; }

private:
    // Gives the oldest visible frame that was not taken.
    const ShownFrame* newer(Time now) override;
    void forget() override;
    bool wants(Time) const override { return true; }
    void promised(Time) override {}
    void give(CapturedFrame& frame) override;
    void miss() override { ++missed_; }
    std::size_t maxHeld() const override { return waiting_.size(); }
    CapturedFrame* oldest(Time now) const;

    // A ring: the reader takes frames taken_ .. given_, the render thread releases frames released_
    // .. taken_.
    std::vector<CapturedFrame*> waiting_;
    std::atomic<std::size_t> given_ = 0, taken_ = 0;
    std::size_t released_ = 0;
    std::atomic<std::int64_t> missed_ = 0;
};

// Gives the newest frame, for a reader that follows the show. A reader that does not read costs
// only this slot.
class NewestFrame final : public FrameReader {
public:
    // `rate`: maximum frame rate, Hz; infinity for every frame, 0 for only those that ask()
    // requests.
    NewestFrame(const ShownFrame& blank, double rate);

    // Requests one further frame: the first that is drawn for `showTime` or later. If readers of
    // several outputs request a moment that no output has drawn yet, they get frames of the same
    // moment. Thread: that of next().
    void ask(Time showTime) { asked_ = showTime.count(); }

private:
    // Gives the newest visible frame; older ones are dropped.
    const ShownFrame* newer(Time now) override;
    void forget() override;
    bool wants(Time showTime) const override;
    void promised(Time showTime) override;
    void give(CapturedFrame& frame) override;
    // A reader pins up to two frames, its slot two more.
    std::size_t maxHeld() const override { return 4; }

    // A display holds back at most one frame, so if the newest one is not visible yet, the one
    // before it is.
    struct Newest {
        CapturedFrame *frame = nullptr, *before = nullptr;
    };
    static constexpr Time::rep kNothing = Time::max().count();

    Time interval_{}, due_ = Time::min();
    std::atomic<Time::rep> asked_ = kNothing;
    LatestValue<Newest> slot_;
    CapturedFrame* given_ = nullptr;  // the newest
    std::int64_t taken_ = -1;         // sequence number of the frame taken last
};

// The only place where shown frames leave the renderer. There is one for each output. Who reads
// what:
//
//   a recording                      every frame            addQueue(), since none may be missing
//   the simulated site's projectors  the newest             addNewest(infinity)
//   a prediction of the camera view  the newest             addNewest(infinity)
//   the operator's screenshot        one of a moment ahead  addNewest(0), ask()
//   thumbnails for a console         some per second        addNewest(rate), then resizedLight()
//   pictures drawn off-screen        each once it is drawn  addNewest(infinity), finish()
//
// For each frame call: draw; capture(); the display's present(); publish(). A frame is copied from
// the GPU once if any reader wants it, and not at all otherwise. The render thread queues the copy
// and never waits for it; readers copy the pixels from there on their own threads. A copy that is
// not complete after the display's present() is handed out with a later frame. While kMaxUnderWay
// copies are under way, further frames are dropped, and queues count them. Does not allocate after
// prepare().
//
// Thread: the render thread, with the output's context current in capture(), publish(), prepare(),
// finish() and the destructor; after forget() the destructor needs no context. Each reader may be
// used from one other thread.
class FrameTap {
public:
    // `size`: pixels of the output's display.
    FrameTap(std::size_t output, glm::ivec2 size);

    // Adds a reader, which lives as long as the tap. At most 32, and only before the first frame.
    FrameQueue& addQueue(std::size_t depth = 4);
    NewestFrame& addNewest(double rate);

    // Allocates memory for all frames that the readers can hold, which otherwise happens when a
    // frame needs it. Error: OpenGL has no memory left.
    Result<void> prepare();
    // Call when the context is lost: drops every frame that no reader has taken, without OpenGL
    // calls. prepare() allocates in the next context.
    void forget();
    // After draw(): starts to copy `framebuffer`, drawn for show time `showTime`, if a reader wants
    // it.
    void capture(unsigned framebuffer, Time showTime);
    // After a successful present(): the captured frame was shown. Do not call it after a failed
    // one.
    void publish(const Shown& shown);
    // Waits for all copies and hands them out: after the last frame, or if this one is needed at
    // once.
    void finish();

private:
    static constexpr std::size_t kMaxUnderWay = 3, kMaxReaders = 32;
    template <class Reader, class... Arguments>
    Reader& add(Arguments... arguments);
    std::size_t maxHeld() const;
    Result<void> addFrame();
    CapturedFrame* unused();  // null: OpenGL has no memory left
    void handOut(CapturedFrame& frame);

    const ShownFrame blank_;  // what readers start with; its image has the display's size
    std::vector<std::unique_ptr<FrameReader>> readers_;
    std::deque<CapturedFrame> frames_;   // allocated once there is a display, which may be after the readers were added
    CapturedFrame* captured_ = nullptr;  // the current frame, if a reader wants it
    std::uint32_t missing_ = 0;          // which readers want the current frame if it cannot be copied
    std::int64_t captures_ = 0;
    BoundedQueue<CapturedFrame*, kMaxUnderWay> underWay_;  // shown, perhaps not copied yet
};

}  // namespace fantascope::render
