#pragma once

#include "app/base/interrupt.h"
#include "app/base/terminal_keys.h"

#include "core/clock.h"

#include <functional>
#include <optional>

namespace fantascope::app {

// Lets a person control long work: the space bar pauses and resumes it; escape, q and Ctrl-C end it
// with the best so far. Keys come from the terminal and from `listen`. Thread: one at a time.
class Attendance {
public:
    using Listen = std::function<std::optional<char>()>;  // the next key; never waits

    // The clock outlives it.
    explicit Attendance(Clock& clock, Listen listen = {}) : clock_(clock), listen_(std::move(listen)) {}

    // Call it between two steps of the work: false when the work is to end. Blocks while the work
    // is paused, and calls whilePaused now and then.
    bool goesOn(const std::function<void()>& whilePaused = {});
    // Total length of all pauses so far, which budgets leave out.
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
