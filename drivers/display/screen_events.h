#pragma once

#include "device/screen_event.h"

#include "core/bounded_queue.h"
#include "core/clock.h"

#include <atomic>
#include <optional>

namespace fantascope::drivers {

// What a person does at a window, on its way from the window system to whoever takes it. The
// pointer may move a thousand times a second, so of moves on end only the newest is kept. Keys and
// buttons that find no room are counted as lost: nobody took any for seconds.
// Thread: give() and flush() on one, take() on one other, lastLost() on any. Nobody waits.
class ScreenEvents {
public:
    static constexpr std::size_t kMost = 256;

    void give(const ScreenEvent& event) {
        if (event.kind == ScreenEvent::Kind::PointerMoved) {
            move_ = event;
            return;
        }
        flush();
        if (!events_.push(event)) lost_ = event.moment.count();
    }
    // Gives the newest move, if it was not given yet. Where there is no room it is given later.
    void flush() {
        if (move_ && events_.push(*move_)) move_.reset();
    }
    std::optional<ScreenEvent> take() { return events_.pop(); }
    // The moment of the newest key or button that was lost; nothing: none was.
    std::optional<Time> lastLost() const {
        const Time::rep lost = lost_;
        return lost == kNone ? std::nullopt : std::optional(Time(lost));
    }

private:
    static constexpr Time::rep kNone = Time::min().count();
    BoundedQueue<ScreenEvent, kMost> events_;
    std::optional<ScreenEvent> move_;
    std::atomic<Time::rep> lost_ = kNone;
};

}  // namespace fantascope::drivers
