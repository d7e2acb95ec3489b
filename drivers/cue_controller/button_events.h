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

// Turns a device's button changes into CueController events, with debouncing. A press comes out at
// once. Further changes within the debounce time after a press or a release are held back until the
// time is over, and come out in the order in which they happened. No release overtakes another.
// Thread: poll() is bound to the input thread, everything else to the device's thread.
class ButtonEvents {
public:
    static constexpr std::size_t kMaxWaiting = 1024;  // unpolled events; further presses are dropped, with their releases

    explicit ButtonEvents(Time debounce) : debounce_(debounce) {}

    // The state before the device is in service: a button that is down now makes no press, and its
    // release is not reported.
    void setInitial(const std::vector<ButtonChange>& changes);
    void feed(const std::vector<ButtonChange>& changes, Time now);
    // Emits changes whose debounce time is over.
    void flush(Time now);
    // When to call flush() next; nothing: no change is held back.
    std::optional<Time> nextFlush() const;
    // The device is lost: buttons whose press was polled go up; unpolled events are dropped.
    void deviceLost(Time now);

    std::optional<ButtonEvent> poll();

private:
    struct Contact {
        bool isDown = false;  // as last emitted
        Time settledAt{};     // the end of its debounce time
    };
    void emit(int button, Contact& contact, bool down, Time now);
    void push(int button, bool down, Time now);

    const Time debounce_;
    std::map<int, Contact> contacts_;
    std::deque<int> pending_;   // buttons that differ from what was emitted, the longest first
    std::set<int> downBefore_;  // down since before the device was in service

    std::mutex mutex_;  // guards what follows
    std::deque<ButtonEvent> events_;
    std::set<int> pressed_;  // press queued or polled, release not yet queued
    std::set<int> polled_;   // press polled, release not yet polled
};

}  // namespace fantascope::drivers
