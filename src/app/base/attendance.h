#pragma once

#include "app/base/interrupt.h"
#include "app/base/terminal_keys.h"

#include "core/clock.h"

#include <functional>
#include <optional>

namespace fantascope::app {

// The person who waits for long work: the space bar pauses it and goes on; escape, q and Ctrl-C end
// it with the best so far. Keys come from the terminal, and from whatever else is listened to.
// Thread: one at a time.
class Attendance {
public:
    using Listen = std::function<std::optional<char>()>;  // the next key, never waits

    // The clock outlives it.
    explicit Attendance(Clock& clock, Listen listen = {}) : clock_(clock), listen_(std::move(listen)) {}

    // To be asked between two steps of the work: whether it goes on. Waits while the work is
    // paused, and calls whilePaused now and then.
    bool goesOn(const std::function<void()>& whilePaused = {});
    // How long the work stood still so far; budgets leave it out.
    Time paused() const { return paused_; }

private:
    std::optional<char> nextKey();

    Clock& clock_;
    const Listen listen_;
    const Interrupt interrupt_;
    TerminalKeys terminal_;
    Time paused_{};
};

// A clock that leaves pauses out: the budget of work that a person may pause. It stands still once
// a pause is over, by as much as that took.
// Thread: bound to that of the attendance.
class WorkClock final : public Clock {
public:
    // Both outlive it.
    WorkClock(Clock& clock, const Attendance& attendance) : clock_(clock), attendance_(attendance) {}
    Time now() const override { return clock_.now() - attendance_.paused(); }
    void sleepUntil(Time time) override { clock_.sleepUntil(time + attendance_.paused()); }

private:
    Clock& clock_;
    const Attendance& attendance_;
};

}  // namespace fantascope::app
