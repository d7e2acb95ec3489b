#pragma once

#include "device/status.h"

#include "core/clock.h"

#include <optional>
#include <string>

namespace fantascope {

// A button of the hand controller went down or up.
struct ButtonEvent {
    int button = 0;  // the device's own number, from 1
    bool pressed = false;
    Time at{};  // when it arrived, on the clock that open() was handed
};

// What a button is good for now, as its lamp or the picture on its key says it.
struct ButtonLight {
    enum class State {
        Off,     // a press would do nothing, or nothing that matters now
        Ready,   // a press would do something
        Active,  // what it stands for is going on
        Alarm    // what it stands for is on, and the operator had better know
    };
    State state = State::Off;
    std::string word;  // for a key with a picture: "GO"; empty: the colour alone
    friend bool operator==(const ButtonLight&, const ButtonLight&) = default;
};

// The hand-held device that steps the cues. Thread: bound to the input thread.
class CueController : public Device {
public:
    // The next event, oldest first; nothing when there is none. Never waits. Events of one button
    // alternate, a press first; a key's auto-repeat is left out. Plugging in, unplugging or noise
    // never makes a press, nor does one that waited while the device was lost come out after its
    // return; a button that was down when the device was lost is reported up.
    virtual std::optional<ButtonEvent> poll() = 0;

    // Shows what a button is good for, until it is told otherwise; all are off at first. Never
    // waits and never makes a press. Of several lights for a button the newest is shown, and it is
    // sent only where it differs from what is shown. A lost device shows all of it again when it
    // returns; at the end all is off, as far as the device still answers. What has no lamp takes it
    // silently.
    virtual void light(int button, const ButtonLight& light) = 0;
};

}  // namespace fantascope
