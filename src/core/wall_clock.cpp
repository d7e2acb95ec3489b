#include "core/wall_clock.h"

#include "core/check.h"

#include <ctime>

namespace fantascope {

WallTime wallTimeOf(Time utc, Time offset) {
    const Time local = utc + offset;
    const auto day = std::chrono::floor<std::chrono::days>(local);
    return {utc, offset, std::chrono::year_month_day(std::chrono::sys_days(day)), local - day};
}

WallTime localTimeOf(Time utc) {
    // The compiler's std::chrono has no time zones yet.
    const auto whole = static_cast<std::time_t>(std::chrono::floor<std::chrono::seconds>(utc).count());
    std::tm civil{};
    ::tzset();  // localtime_r() need not look at TZ
    FANTASCOPE_CHECK(::localtime_r(&whole, &civil) != nullptr, "64 bits of nanoseconds end in 2262");
    return wallTimeOf(utc, std::chrono::seconds(civil.tm_gmtoff));
}

WallTime SystemWallClock::now() const {
    return localTimeOf(std::chrono::duration_cast<Time>(std::chrono::system_clock::now().time_since_epoch()));
}

void ManualWallClock::set(Time utc, Time offset) {
    const std::lock_guard lock(mutex_);
    utc_ = utc;
    offset_ = offset;
}

WallTime ManualWallClock::now() const {
    const std::lock_guard lock(mutex_);
    return wallTimeOf(utc_, offset_);
}

}  // namespace fantascope
