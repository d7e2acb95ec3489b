#pragma once
// Time is a value: code below app never reads the real clock, but is given a Clock.

#include <atomic>
#include <chrono>

namespace fantascope {

// A duration, and by convention a point in time on a Clock (since its start) or in a show (since
// the show's start).
using Time = std::chrono::nanoseconds;

constexpr double seconds(Time time) { return std::chrono::duration<double>(time).count(); }
// Rounds to the nearest nanosecond. |seconds| < 9e9.
Time fromSeconds(double seconds);
// The time of tick `index` of a regular train of `hertz` ticks per second that starts at 0; exact
// to a nanosecond for any index. hertz > 0.
Time tickTime(std::int64_t index, double hertz);
// The last tick at or before `time`: tickTime(tickAt(t, hz), hz) <= t < tickTime(tickAt(t, hz) + 1,
// hz).
std::int64_t tickAt(Time time, double hertz);

// Thread: every method of every clock is thread-safe.
class Clock {
public:
    virtual ~Clock() = default;
    // Time since the clock's start; never decreases.
    virtual Time now() const = 0;
    // Returns once now() >= time.
    virtual void sleepUntil(Time time) = 0;
};

// The machine's monotonic clock, from the moment of construction.
class SteadyClock final : public Clock {
public:
    SteadyClock();
    Time now() const override;
    void sleepUntil(Time time) override;

private:
    std::chrono::steady_clock::time_point start_;
};

// The monotonic clock of the kernel's time stamps (CLOCK_MONOTONIC), since the machine's start. It
// runs at the rate of a SteadyClock, so their difference is constant.
Time kernelTime();

// A clock that moves only when told to, for tests and for rehearsals as fast as possible.
// sleepUntil() moves it.
class ManualClock final : public Clock {
public:
    Time now() const override { return now_.load(); }
    void sleepUntil(Time time) override { advanceTo(time); }
    void advance(Time by) { advanceTo(now() + by); }
    // Moves forward to `time`; does nothing if it is already later.
    void advanceTo(Time time);

private:
    std::atomic<Time> now_{Time::zero()};
};

}  // namespace fantascope
