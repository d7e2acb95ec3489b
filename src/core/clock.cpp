#include "core/clock.h"

#include <cmath>
#include <thread>

namespace fantascope {

Time fromSeconds(double seconds) { return Time(std::llround(seconds * 1e9)); }

Time tickTime(std::int64_t index, double hertz) {
    return Time(std::llround(static_cast<long double>(index) * 1e9L / static_cast<long double>(hertz)));
}

std::int64_t tickAt(Time time, double hertz) {
    auto index =
        static_cast<std::int64_t>(std::floor(static_cast<long double>(time.count()) * static_cast<long double>(hertz) / 1e9L));
    while (tickTime(index, hertz) > time) --index;
    while (tickTime(index + 1, hertz) <= time) ++index;
    return index;
}

SteadyClock::SteadyClock() : start_(std::chrono::steady_clock::now()) {}

Time SteadyClock::now() const { return std::chrono::duration_cast<Time>(std::chrono::steady_clock::now() - start_); }

void SteadyClock::sleepUntil(Time time) { std::this_thread::sleep_until(start_ + time); }

Time kernelTime() { return std::chrono::duration_cast<Time>(std::chrono::steady_clock::now().time_since_epoch()); }

void ManualClock::advanceTo(Time time) {
    Time seen = now_.load();
    while (seen < time && !now_.compare_exchange_weak(seen, time)) {
    }
}

}  // namespace fantascope
