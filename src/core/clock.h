#pragma once
// Time is a value. Nobody below app reads the real clock: whoever needs the time is handed a Clock.

#include <atomic>
#include <chrono>

namespace fantascope {

// A span of time, and by convention a point on a Clock (since its start) or in a show (since the
// show's start).
using Time = std::chrono::nanoseconds;

constexpr double seconds(Time time) { return std::chrono::duration<double>(time).count(); }
// Rounds to the nearest nanosecond. |seconds| < 9e9.
Time fromSeconds(double seconds);
// The time of tick number `index` of a regular train of `hertz` ticks a second, from 0; exact to a
// nanosecond for any index. hertz > 0.
Time tickTime(std::int64_t index, double hertz);
// The number of the last tick at or before `time`: tickTime(tickAt(t, hz), hz) <= t <
// tickTime(tickAt(t, hz) + 1, hz).
std::int64_t tickAt(Time time, double hertz);

// Thread: every method of every clock is thread-safe.
class Clock {
public:
    virtual ~Clock() = default;
    // Time since the clock's start; never goes back.
    virtual Time now() const = 0;
    // Returns once now() >= time; at once if it is already.
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

// The monotonic clock by which the system's kernel stamps what devices give (CLOCK_MONOTONIC),
// since the machine's start. It runs as fast as a SteadyClock does, so that a stamp and a Clock's
// time differ by what the two differ by now.
Time kernelTime();

// A clock that moves only when told to: in tests, and to rehearse as fast as possible. sleepUntil
// moves it.
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
