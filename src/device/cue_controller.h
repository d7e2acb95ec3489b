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

// What a press of a button would do now, shown by its lamp or the picture on its key.
struct ButtonLight {
    enum class State {
        Off,     // a press would do nothing, or nothing of interest now
        Ready,   // a press would do something
        Active,  // its action is going on
        Alarm    // its action is on, and the operator should know
    };
    State state = State::Off;
    std::string word;  // for a key with a picture: "GO"; empty: colour only
    friend bool operator==(const ButtonLight&, const ButtonLight&) = default;
};

// The hand-held device that steps the cues. Thread: bound to the input thread.
class CueController : public Device {
public:
    // The next event, oldest first; nothing if there is none. Never waits. The events of a button
    // alternate, a press first; auto-repeat is left out. Plugging in, unplugging or noise never
    // makes a press. Presses that were not polled before a loss are dropped; a button that was down
    // at the loss is reported up.
    virtual std::optional<ButtonEvent> poll() = 0;

    // Sets a button's light until the next call; all are off at first. Never waits and never makes
    // a press. Only the newest light of a button is shown, and only changes are sent. After a loss
    // all lights are shown again. At the end all go off, if the device still answers. Buttons
    // without a lamp ignore it.
    virtual void light(int button, const ButtonLight& light) = 0;
};

}  // namespace fantascope
