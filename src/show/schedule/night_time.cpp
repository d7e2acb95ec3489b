#include "show/schedule/night_time.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>

namespace fantascope::show {

namespace {

using std::chrono::hours;
using std::chrono::minutes;

constexpr std::array<std::string_view, 7> kWeekdays = {"sun", "mon", "tue", "wed", "thu", "fri", "sat"};
constexpr std::array<std::string_view, 12> kMonths = {"Jan", "Feb", "Mar", "Apr", "May", "Jun",
                                                      "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"};

std::optional<unsigned> digitsOf(std::string_view text) {
    unsigned number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    return error == std::errc() && end == text.data() + text.size() ? std::optional(number) : std::nullopt;
}

// "22:30", up to 23:59.
std::optional<Time> readClock(std::string_view text) {
    const std::size_t colon = text.find(':');
    if (colon == std::string_view::npos || colon > 2 || text.size() - colon != 3) return std::nullopt;
    const auto hour = digitsOf(text.substr(0, colon)), minute = digitsOf(text.substr(colon + 1));
    if (!hour || !minute || *hour > 23 || *minute > 59) return std::nullopt;
    return hours(*hour) + minutes(*minute);
}

std::string_view trimmed(std::string_view text) {
    const std::size_t first = text.find_first_not_of(' '), last = text.find_last_not_of(' ');
    return first == std::string_view::npos ? "" : text.substr(first, last - first + 1);
}

std::optional<NightTime> parse(std::string_view text) {
    if (const auto clock = readClock(text)) return NightTime{std::nullopt, *clock};
    const std::size_t sign = text.find_first_of("+-");
    const auto event = std::ranges::find(kSunEvents, trimmed(text.substr(0, sign)));
    if (event == kSunEvents.end()) return std::nullopt;
    NightTime time{static_cast<SunEvent>(event - kSunEvents.begin())};
    if (sign == std::string_view::npos) return time;
    const auto offset = readClock(trimmed(text.substr(sign + 1)));
    if (!offset) return std::nullopt;
    time.offset = text[sign] == '-' ? -*offset : *offset;
    return time;
}

}  // namespace

Date Whereabouts::nightAt(Time utc) const {
    const WallTime time = zone.at(utc);
    return time.timeOfDay >= hours(12) ? time.date : Date(std::chrono::sys_days(time.date) - std::chrono::days(1));
}

std::optional<Time> NightTime::in(Date night, const Whereabouts& place) const {
    const Date morning(std::chrono::sys_days(night) + std::chrono::days(1));
    if (!event) return place.zone.utcOf(offset < hours(12) ? morning : night, offset);
    const auto sun = timeOf(*event, place.noonOf(night), place.latitude, place.longitude);
    if (!sun) return std::nullopt;
    return std::clamp(*sun + offset, place.noonOf(night), place.noonOf(morning));
}

Result<NightTime> readNightTime(const ConfigNode& node) {
    const std::string text = TRY(node.text());
    if (const auto time = parse(text)) return *time;
    return node.error(
        fmt::format("'{}' is no time of a night; write it like '22:30' or '{} + 0:15', with {} or a part of the night: {}", text,
                    kSunEvents[0], kSunEvents[0], fmt::join(kSunEvents, ", ")));
}

std::string textOf(const NightTime& time) {
    if (!time.event) return clockOf(time.offset);
    const std::string_view event = kSunEvents[static_cast<std::size_t>(*time.event)];
    if (time.offset == Time{}) return std::string(event);
    const Time size = std::chrono::abs(time.offset);
    return fmt::format("{} {} {}:{:02}", event, time.offset < Time{} ? '-' : '+', size / hours(1), size / minutes(1) % 60);
}

Result<Weekdays> readWeekdays(const ConfigNode& node) {
    Weekdays days;
    const std::vector<std::string> names(kWeekdays.begin(), kWeekdays.end());
    for (const ConfigNode& item : TRY(node.items(1))) days.set(TRY(item.choice(names)));
    return days;
}

bool isOn(Weekdays days, Date night) { return days.test(std::chrono::weekday(std::chrono::sys_days(night)).c_encoding()); }

Result<Date> dateOf(const std::string& text) {
    const std::string_view view = text;
    const bool isLike = view.size() == 10 && view[4] == '-' && view[7] == '-';
    const auto year = isLike ? digitsOf(view.substr(0, 4)) : std::nullopt,
               month = isLike ? digitsOf(view.substr(5, 2)) : std::nullopt,
               day = isLike ? digitsOf(view.substr(8)) : std::nullopt;
    if (!year || !month || !day) return Error(fmt::format("'{}' is no date; write it like '2026-12-24'", text));
    const Date date{std::chrono::year(static_cast<int>(*year)), std::chrono::month(*month), std::chrono::day(*day)};
    constexpr int kFirst = 1970, kLast = 2200;  // what 64 bits of nanoseconds hold, roughly
    if (!date.ok() || static_cast<int>(*year) < kFirst || static_cast<int>(*year) > kLast)
        return Error(fmt::format("there is no date '{}'", text));
    return date;
}

Result<DateAndTime> dateAndTimeOf(const std::string& text) {
    constexpr std::size_t kDate = 10;
    const auto clock =
        text.size() > kDate && text[kDate] == ' ' ? readClock(std::string_view(text).substr(kDate + 1)) : std::nullopt;
    if (!clock) return Error(fmt::format("'{}' is no date and time; write it like '2026-12-24 21:30'", text));
    return DateAndTime{TRY(dateOf(text.substr(0, kDate))), *clock};
}

Result<Date> readDate(const ConfigNode& node) {
    const auto date = dateOf(TRY(node.text()));
    if (!date) return node.error(date.error());
    return *date;
}

std::string textOf(Date date) {
    std::string day(kWeekdays[std::chrono::weekday(std::chrono::sys_days(date)).c_encoding()]);
    day[0] = static_cast<char>(day[0] - 'a' + 'A');
    return fmt::format("{} {} {} {}", day, static_cast<unsigned>(date.day()), kMonths[static_cast<unsigned>(date.month()) - 1],
                       static_cast<int>(date.year()));
}

std::string clockOf(Time timeOfDay) { return fmt::format("{:02}:{:02}", timeOfDay / hours(1), timeOfDay / minutes(1) % 60); }

}  // namespace fantascope::show
