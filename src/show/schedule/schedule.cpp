#include "show/schedule/schedule.h"

#include "show/schedule/place.h"

#include <fmt/format.h>

namespace fantascope::show {

namespace {

constexpr double kLongestFade = 60;  // s

Result<std::optional<NightTime>> readOptionalTime(const ConfigNode& node) { return std::optional(TRY(readNightTime(node))); }

Result<Schedule::Item> readItem(const ConfigNode& node, const std::vector<std::string>& cues) {
    Schedule::Item item;
    ConfigFields fields(node);
    fields.read("cue", item.cue, [&](const ConfigNode& value) { return value.choice(cues); });
    fields.read("from", item.from, readNightTime);
    fields.optional().read("until", item.until, readOptionalTime);
    fields.optional().read("on", item.on, readWeekdays);
    TRY(fields.finish());
    return item;
}

Result<AllowedHours> readHours(const ConfigNode& node) {
    AllowedHours hours{.from = {}, .until = {}, .on = Weekdays().set()};
    ConfigFields fields(node);
    fields.optional().read("from", hours.from, readOptionalTime);
    fields.optional().read("until", hours.until, readOptionalTime);
    fields.optional().read("on", hours.on, readWeekdays);
    TRY(fields.finish());
    return hours;
}

}  // namespace

Result<Schedule> readSchedule(const ConfigNode& node, const std::vector<std::string>& cues) {
    Schedule schedule;
    schedule.at = node.here();
    const auto optionalDate = [](const ConfigNode& value) -> Result<std::optional<Date>> {
        return std::optional(TRY(readDate(value)));
    };
    ConfigFields fields(node);
    fields.optional().read("first", schedule.first, optionalDate);
    fields.optional().read("last", schedule.last, optionalDate);
    fields.optional().list("dark", schedule.dark, readDate);
    fields.optional().time("fade", schedule.fade, 0, kLongestFade);
    fields.list(
        "nights", schedule.items, [&](const ConfigNode& item) { return readItem(item, cues); }, 1);
    TRY(fields.finish());
    if (schedule.first && schedule.last && *schedule.last < *schedule.first)
        return node.error("'last' is before 'first', so there is no night");
    return schedule;
}

Result<Place> readPlace(const ConfigNode& node) {
    double latitude = 0, longitude = 0;
    std::optional<TimeZone> zone;
    std::vector<AllowedHours> hours;
    ConfigFields fields(node);
    fields.angle("latitude", latitude, -90, 90);
    fields.angle("longitude", longitude, -180, 180);
    fields.read("time_zone", zone, [](const ConfigNode& value) -> Result<std::optional<TimeZone>> {
        auto named = TimeZone::named(TRY(value.text()));
        if (!named) return value.error(named.error());
        return std::optional(*named);
    });
    fields.optional().list("hours", hours, readHours, 1);
    TRY(fields.finish());
    return Place{{latitude, longitude, *zone}, std::move(hours)};
}

}  // namespace fantascope::show
