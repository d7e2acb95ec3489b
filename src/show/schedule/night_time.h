#pragma once

#include "show/schedule/sun.h"
#include "show/schedule/time_zone.h"

#include "core/clock.h"
#include "core/config/config.h"
#include "core/result.h"

#include <bitset>
#include <chrono>
#include <optional>
#include <string>

namespace fantascope::show {

// A night begins at noon, ends at the next noon, and has the date of its evening.
using Date = std::chrono::year_month_day;

// Where a show stands on the earth, and how its clocks are set.
struct Whereabouts {
    double latitude = 0, longitude = 0;  // radians, north and east
    TimeZone zone;

    Time noonOf(Date night) const { return zone.utcOf(night, std::chrono::hours(12)); }
    // The night of a moment.
    Date nightAt(Time utc) const;
};

// A moment of any night, as its author wrote it: "22:30", "sunset + 0:15".
struct NightTime {
    std::optional<SunEvent> event;
    Time offset{};  // from the event, or the time of day, which is after midnight if it is before noon
    friend bool operator==(const NightTime&, const NightTime&) = default;

    // When it is in a night, at its noon at the earliest and at the next one at the latest.
    // Nothing: the sun does no such thing in that night.
    std::optional<Time> in(Date night, const Whereabouts& place) const;
};

// "22:30", "sunset", "civil dusk + 0:15", "sunrise - 1:00". Error: place, advice.
Result<NightTime> readNightTime(const ConfigNode& node);
std::string textOf(const NightTime& time);

// Nights of the week, by std::chrono::weekday::c_encoding().
using Weekdays = std::bitset<7>;
// A list of "mon" .. "sun". Error: place, advice.
Result<Weekdays> readWeekdays(const ConfigNode& node);
bool isOn(Weekdays days, Date night);

// "2026-12-24". Error: place; there is no such date.
Result<Date> readDate(const ConfigNode& node);
Result<Date> dateOf(const std::string& text);
// A moment by the clocks of a place.
struct DateAndTime {
    Date date;
    Time timeOfDay{};
};
// "2026-12-24 21:30".
Result<DateAndTime> dateAndTimeOf(const std::string& text);
// "Thu 24 Dec 2026".
std::string textOf(Date date);
// "22:30".
std::string clockOf(Time timeOfDay);

}  // namespace fantascope::show
