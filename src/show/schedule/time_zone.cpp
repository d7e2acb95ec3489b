#include "show/schedule/time_zone.h"

#include "core/config/config.h"

#include <date/tz.h>
#include <fmt/format.h>

#include <exception>
#include <string>
#include <vector>

namespace fantascope::show {

Result<TimeZone> TimeZone::named(std::string_view name) {
    try {
        const date::tzdb& zones = date::get_tzdb();
        const auto found = std::ranges::find(zones.zones, name, [](const date::time_zone& zone) { return zone.name(); });
        if (found != zones.zones.end()) return TimeZone(&*found);
        std::vector<std::string> names;
        for (const date::time_zone& zone : zones.zones) names.push_back(zone.name());
        const std::string nearest = nearestName(name, names);
        return Error(fmt::format("no time zone is called '{}'{}", name,
                                 nearest.empty() ? "; a name is like 'Europe/Vienna'" : " (did you mean '" + nearest + "'?)"));
    } catch (const std::exception& thrown) {
        return Error(fmt::format("this machine has no time zones ({}); install the package tzdata", thrown.what()));
    }
}

std::string_view TimeZone::name() const { return zone_->name(); }

WallTime TimeZone::at(Time utc) const {
    const date::sys_time<std::chrono::seconds> whole(std::chrono::floor<std::chrono::seconds>(utc));
    return wallTimeOf(utc, zone_->get_info(whole).offset);
}

Time TimeZone::utcOf(std::chrono::year_month_day date, Time timeOfDay) const {
    const Time local = std::chrono::sys_days(date).time_since_epoch() + timeOfDay;
    const date::local_time<std::chrono::seconds> whole(std::chrono::floor<std::chrono::seconds>(local));
    const date::local_info info = zone_->get_info(whole);
    if (info.result == date::local_info::nonexistent) return Time(info.first.end.time_since_epoch());
    return local - info.first.offset;
}

}  // namespace fantascope::show
