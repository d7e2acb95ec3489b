#pragma once

#include "drivers/cue_controller/hid_buttons.h"

#include "device/cue_controller.h"

#include "core/clock.h"

#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <vector>

namespace fantascope::drivers {

// Between what a device's buttons do and the events of the CueController. A press comes out at
// once; what its contacts do within the debounce after a press or a release is looked at when that
// is over, in the order in which it happened. No release overtakes another.
// Thread: poll() belongs to the input thread, everything else to the device's.
class ButtonEvents {
public:
    static constexpr std::size_t kMost = 1024;  // presses that nobody polls; later ones are dropped, with their releases

    explicit ButtonEvents(Time debounce) : debounce_(debounce) {}

    // Before the device is in service: what is down now is no press, nor is letting go of it a
    // release.
    void settle(const std::vector<ButtonChange>& changes);
    void take(const std::vector<ButtonChange>& changes, Time now);
    // Lets out what the debounce has held back until `now`.
    void pass(Time now);
    // When there is something to pass().
    std::optional<Time> due() const;
    // The device is gone: what was pressed and polled goes up, what nobody has polled yet never
    // was.
    void lose(Time now);

    std::optional<ButtonEvent> poll();

private:
    struct Contact {
        bool isDown = false;  // as was let out
        Time quietFrom{};     // the end of the debounce
    };
    void letOut(int button, Contact& contact, bool down, Time now);
    void push(int button, bool down, Time now);

    const Time debounce_;
    std::map<int, Contact> contacts_;
    std::deque<int> held_;      // buttons which are not as was let out, longest so first
    std::set<int> downBefore_;  // down since before the device was in service

    std::mutex mutex_;  // of what follows
    std::deque<ButtonEvent> events_;
    std::set<int> pressed_;  // a press of them is in events_ or was polled, and no release yet
    std::set<int> given_;    // a press of them was polled, and no release yet
};

}  // namespace fantascope::drivers
