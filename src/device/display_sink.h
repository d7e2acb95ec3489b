#pragma once

#include <cstdint>
#include <glm/vec2.hpp>

#include "core/clock.h"
#include "core/result.h"
#include "device/status.h"

namespace fantascope {

// When a frame really became visible.
struct Shown {
    std::int64_t refresh = 0;  // the number of the refresh that first showed it, counted by the display
    Time at{};                 // the time of that refresh, on the clock that open() was handed
};

// One output's picture surface with an OpenGL 4.5 core context of its own.
//
// A frame: makeCurrent(); draw into framebuffer(); present(). With several outputs on one render thread the first one leads (paced) and
// the others follow (not paced), so that the thread waits for one refresh and not for each in turn.
//
// The context comes with the first success of makeCurrent() and lives as long as the display: what is in it outlives a loss. Objects in it
// are destroyed while it is current.
// Thread: all methods but status() are bound to the render thread, the context with them.
class DisplaySink : public Device {
public:
    // Pixels of the surface, constant while Running.
    virtual glm::ivec2 size() const = 0;
    // Refreshes a second.
    virtual double refreshRate() const = 0;
    // The refresh that the next paced present() can make at the earliest.
    virtual std::int64_t nextRefresh() const = 0;
    // When refresh `number` takes place (may be an estimate on real hardware).
    virtual Time refreshTime(std::int64_t number) const = 0;

    // Makes this surface's context current. Error: not Running.
    virtual Result<void> makeCurrent() = 0;
    // The GL name of the framebuffer to draw into; its colours are stored sRGB values, row 0 of GL at the bottom of the picture.
    virtual unsigned framebuffer() const = 0;
    // Shows what was drawn; its context is current afterwards. Paced: waits for the next refresh. Otherwise shows at once, within the
    // refresh that is running, and does not wait. Error: not Running: the frame is dropped. Loss: the projector shows nothing.
    virtual Result<Shown> present(bool paced) = 0;
};

}  // namespace fantascope
