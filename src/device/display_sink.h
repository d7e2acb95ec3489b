#pragma once

#include "device/screen_event.h"
#include "device/status.h"

#include "core/clock.h"
#include "core/result.h"

#include <glm/vec2.hpp>

#include <cstdint>
#include <optional>

namespace fantascope {

// When a frame really became visible.
struct Shown {
    std::int64_t refresh = 0;  // the number of the refresh that first showed it, counted by the display
    Time at{};                 // the time of that refresh, on the clock that open() was handed; may be up to one period ahead
    // When the picture took the place of the one before: as far as the display can tell, and at
    // `at` where it holds it.
    Time swapped{};
    Time swap{};  // how long it took to hand it over, without the wait for a refresh
};

// One output's picture surface with an OpenGL 4.5 core context of its own.
//
// A frame: poll(); makeCurrent(); draw into framebuffer(); finish(); present(). With several
// outputs on one render thread all are finished before the first is presented, so that they change
// together; the first one leads, at its own pace, and the others follow, so that the thread waits
// for one refresh and not for each in turn.
//
// A display may hold one finished frame until its refresh comes, so that the next one can be drawn
// meanwhile: a moment in which the machine is busy elsewhere then does not show.
//
// The context comes with the first success of makeCurrent(), on most machines before the display
// itself is there. It outlives a display that is unplugged, with everything in it, and can be made
// ready for a display that is to come. Objects in it are destroyed while it is current.
//
// A context is lost only with what it was made on, such as the X server. Then poll() returns false,
// context() changes, and everything in the context is lost: forget it without OpenGL calls before
// the next poll(). Until then memory that was mapped from it can be read. A new context comes when
// the display does, and has a number of its own.
// Thread: all methods but status() and pollEvent() are bound to the render thread, the context with
// them. The render thread may lend the context: after its release() another thread may call
// makeCurrent(), framebuffer(), finish() and, at its end, release(). Until then the render thread
// calls nothing of this display.
class DisplaySink : public Device {
public:
    // Pixels of the surface, constant while Running.
    virtual glm::ivec2 size() const = 0;
    // Refreshes a second.
    virtual double refreshRate() const = 0;
    // The refresh that the next leading frame can make at the earliest: the first one to come that
    // shows no frame yet.
    virtual std::int64_t nextRefresh() const = 0;
    // When refresh `number` takes place (may be an estimate on real hardware).
    virtual Time refreshTime(std::int64_t number) const = 0;

    // Takes in what happened to the display meanwhile, and brings it back where that is due:
    // whether it is Running. Waits for nobody.
    virtual bool poll() = 0;
    // The number of the context that makeCurrent() makes current, 1 or more; 0: there is none. No
    // two contexts of a display have the same number. Changes in poll() and makeCurrent() alone.
    virtual int context() const = 0;
    // Makes this surface's context current, Running or not. Error: there is none.
    virtual Result<void> makeCurrent() = 0;
    // Its context is current on the calling thread no longer, so that another thread may have it.
    virtual void release() = 0;
    // The GL name of the framebuffer to draw into; its colours are stored sRGB values, row 0 of GL
    // at the bottom of the picture.
    virtual unsigned framebuffer() const = 0;
    // Waits until what was drawn is complete and only remains to be shown; its context is current
    // afterwards. Error: there is none.
    virtual Result<void> finish() = 0;
    // Shows what was finished; its context is current afterwards. Error: not Running: the frame is
    // dropped. Loss: the projector shows nothing. A leading frame is shown at nextRefresh(), and
    // the call returns once another may be drawn: at that refresh, or up to one period earlier
    // where the display holds a frame.
    virtual Result<Shown> present() = 0;
    // A following frame is shown together with one that another display shows at `leading`, or as
    // soon after as can be, and waits for no refresh but that one: where `leading` is past it is
    // shown at once, within the refresh that is running.
    virtual Result<Shown> presentWith(Time leading) = 0;

    // The next thing that a person did at it, oldest first; nothing where nobody can do anything.
    // Never waits. Thread: one, which may be another than the render thread.
    virtual std::optional<ScreenEvent> pollEvent() { return std::nullopt; }
};

}  // namespace fantascope
