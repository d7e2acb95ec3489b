#pragma once

#include "core/clock.h"
#include "core/result.h"
#include "core/wall_clock.h"

#include <chrono>
#include <string_view>

namespace date {
class time_zone;
}

namespace fantascope::show {

// How the clocks of a place are set, summer time included, by the machine's time zone database.
// Value type. Thread: any.
class TimeZone {
public:
    // "Europe/Vienna". Error: there is none of that name, with the nearest one; or the machine has
    // no database.
    static Result<TimeZone> named(std::string_view name);

    std::string_view name() const;
    WallTime at(Time utc) const;
    // When the clocks show a time of day, 0..24 h. The first such moment if they show it twice; the
    // moment at which they are put forward if they never show it.
    Time utcOf(std::chrono::year_month_day date, Time timeOfDay) const;

private:
    explicit TimeZone(const date::time_zone* zone) : zone_(zone) {}

    const date::time_zone* zone_;  // of the database, which is never released
};

}  // namespace fantascope::show
