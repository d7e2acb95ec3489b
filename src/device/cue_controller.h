#pragma once

#include "device/status.h"

#include "core/clock.h"

#include <optional>

namespace fantascope {

// A button of the hand controller went down or up.
struct ButtonEvent {
    int button = 0;  // the device's own number, from 1
    bool pressed = false;
    Time at{};  // when it arrived, on the clock that open() was handed
};

// The hand-held device that steps the cues. Thread: bound to the input thread.
class CueController : public Device {
public:
    // The next event, oldest first; nothing when there is none. Never waits. Events of one button alternate, a press first; a
    // key's auto-repeat is left out. Plugging in, unplugging or noise never makes a press, nor does one that waited while the
    // device was lost come out after its return; a button that was down when the device was lost is reported up.
    virtual std::optional<ButtonEvent> poll() = 0;
};

}  // namespace fantascope
