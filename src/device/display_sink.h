#pragma once

#include "device/screen_event.h"
#include "device/status.h"

#include "core/clock.h"
#include "core/result.h"

#include <glm/vec2.hpp>

#include <cstdint>
#include <optional>

namespace fantascope {

// When a frame became visible.
struct Shown {
    std::int64_t refresh = 0;  // the refresh that first showed it, as counted by the display
    Time at{};                 // the time of that refresh, on the clock that open() was handed; may be up to one period ahead
    // When the buffers were swapped, as far as the display can tell; equal to `at` if the display
    // holds the frame.
    Time swapped{};
    Time swap{};  // how long the swap took, without the wait for a refresh
};

// The picture surface of one output, with an OpenGL 4.5 core context of its own.
//
// A frame: poll(); makeCurrent(); draw into framebuffer(); finish(); present(). If one render
// thread serves several outputs, all are finished before the first is presented, so that they
// change together. The first one leads at its own pace and the others follow, so the thread waits
// for one refresh, not for each in turn.
//
// A display may hold one finished frame until its refresh, so the next one can be drawn meanwhile.
// This hides short moments in which the machine is busy elsewhere.
//
// The context exists from the first success of makeCurrent(), on most machines before the display
// itself is there. It survives an unplugged display with everything in it, and can be prepared for
// a display that is still missing. Destroy its objects while it is current.
//
// A context is lost only with what it was made on, such as the X server. Then poll() returns false,
// context() changes, and everything in the context is lost: drop it without OpenGL calls before the
// next poll(). Until then, memory that was mapped from it can be read. A new context is made when
// the display comes back; it has a new number.
// Thread: all methods but status() and pollEvent(), and the context, are bound to the render
// thread.
class DisplaySink : public Device {
public:
    // Pixels of the surface; constant while Running.
    virtual glm::ivec2 size() const = 0;
    // Refreshes a second.
    virtual double refreshRate() const = 0;
    // The earliest refresh that the next leading frame can make: the first one to come that has no
    // frame yet.
    virtual std::int64_t nextRefresh() const = 0;
    // When refresh `number` takes place; on real hardware this may be an estimate.
    virtual Time refreshTime(std::int64_t number) const = 0;

    // Handles what happened to the display since the last call, and brings it back when it is time
    // to retry. Never waits. Returns whether it is Running.
    virtual bool poll() = 0;
    // The number of the context that makeCurrent() makes current, from 1; 0: none. Never reused by
    // a display. Changes only in poll() and makeCurrent().
    virtual int context() const = 0;
    // Makes this surface's context current, Running or not. Error: no context.
    virtual Result<void> makeCurrent() = 0;
    // The GL name of the framebuffer to draw into. It holds stored sRGB values; GL's row 0 is the
    // bottom of the picture.
    virtual unsigned framebuffer() const = 0;
    // Waits until drawing is complete, so that only the swap remains. The context is current
    // afterwards. Error: no context.
    virtual Result<void> finish() = 0;
    // Shows the finished frame; the context is current afterwards. Error: not Running; the frame is
    // dropped. Loss: the projector shows nothing. A leading frame is shown at nextRefresh(). The
    // call returns when another may be drawn: at that refresh, or up to one period earlier if the
    // display holds a frame.
    virtual Result<Shown> present() = 0;
    // Shows a following frame together with the frame that another display shows at `leading`, or
    // as soon after as possible. It waits for no other refresh: if `leading` is past, the frame is
    // shown at once.
    virtual Result<Shown> presentWith(Time leading) = 0;

    // The next keyboard or pointer event, oldest first; nothing if there is none, or if the display
    // has no input. Never waits. Thread: one, which may be another than the render thread.
    virtual std::optional<ScreenEvent> pollEvent() { return std::nullopt; }
};

}  // namespace fantascope
