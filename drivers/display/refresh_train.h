#pragma once

#include "core/clock.h"

#include <algorithm>
#include <cstdint>

namespace fantascope::drivers {

// The numbered refreshes of a display, `hertz` per second. Initially number k takes place at
// tickTime(k, hertz). A display that sees its monitor's real refreshes corrects the count by each
// of them. Thread: thread-bound.
class RefreshTrain {
public:
    explicit RefreshTrain(double hertz) : hertz_(hertz) {}

    double hertz() const { return hertz_; }
    // The number of the refresh that is showing at `time`.
    std::int64_t running(Time time) const { return number_ + tickAt(time - at_, hertz_); }
    Time timeOf(std::int64_t number) const { return at_ + tickTime(number - number_, hertz_); }
    // Reports a real refresh at `time` and returns its number: the nearest by the count so far, but
    // never one that was reported before. Later ones count from it.
    std::int64_t seen(Time time) {
        const Time halfPeriod = tickTime(1, 2 * hertz_);
        number_ = std::max(number_ + 1, running(time + halfPeriod));
        at_ = time;
        return number_;
    }
    // Changes the rate from `time` on; the current refresh keeps its number.
    void runAt(double hertz, Time time) {
        number_ = running(time);
        at_ = time;
        hertz_ = hertz;
    }

private:
    double hertz_;
    std::int64_t number_ = 0;  // of the refresh at at_
    Time at_{};
};

}  // namespace fantascope::drivers
