#pragma once
// The time of day, as the people of a place call it. Lengths are measured with a Clock: this one
// jumps when somebody sets it.

#include "core/clock.h"

#include <chrono>
#include <mutex>

namespace fantascope {

// A moment by the clocks of a place.
struct WallTime {
    Time utc{};                          // since 1970-01-01 00:00 UTC, without leap seconds
    Time offset{};                       // of the place's clocks from UTC at that moment
    std::chrono::year_month_day date{};  // by the place's clocks
    Time timeOfDay{};                    // since the date's midnight by the place's clocks, 0..24 h
    friend bool operator==(const WallTime&, const WallTime&) = default;
};

// A moment by clocks that differ by `offset` from UTC.
WallTime wallTimeOf(Time utc, Time offset);
// A moment by the clocks of this machine's zone: that of the environment's TZ, or where it is not
// set, the system's. Thread: any, while nobody changes the environment.
WallTime localTimeOf(Time utc);

// Thread: every method of every wall clock is thread-safe.
class WallClock {
public:
    virtual ~WallClock() = default;
    virtual WallTime now() const = 0;
};

// The machine's, in the machine's zone.
class SystemWallClock final : public WallClock {
public:
    WallTime now() const override;
};

// One that showed `utc` when it was made, and runs as `clock` does, which outlives it.
class RunningWallClock final : public WallClock {
public:
    RunningWallClock(const Clock& clock, Time utc) : clock_(clock), utc_(utc), madeAt_(clock.now()) {}
    WallTime now() const override { return wallTimeOf(utc_ + (clock_.now() - madeAt_), Time{}); }

private:
    const Clock& clock_;
    const Time utc_, madeAt_;
};

// One that shows what it was set to.
class ManualWallClock final : public WallClock {
public:
    void set(Time utc, Time offset);
    WallTime now() const override;

private:
    mutable std::mutex mutex_;  // of:
    Time utc_{}, offset_{};
};

}  // namespace fantascope
