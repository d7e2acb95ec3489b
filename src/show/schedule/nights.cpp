#include "show/schedule/nights.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

namespace fantascope::show {

namespace {

constexpr int kYear = 366;  // nights

Date next(Date date) { return Date(std::chrono::sys_days(date) + std::chrono::days(1)); }

}  // namespace

// When the town allows light; nothing: not in that night.
std::optional<Nights::Interval> Nights::allowedIn(Date night) const {
    const Whereabouts& here = place_.whereabouts;
    const Interval whole{here.noonOf(night), here.noonOf(next(night))};
    if (place_.hours.empty()) return whole;
    const auto hours = std::ranges::find_if(place_.hours, [&](const AllowedHours& each) { return isOn(each.on, night); });
    if (hours == place_.hours.end()) return std::nullopt;
    const auto from = hours->from ? hours->from->in(night, here) : std::optional(whole.from);
    const auto until = hours->until ? hours->until->in(night, here) : std::optional(whole.until);
    return from && until && *from < *until ? std::optional(Interval{*from, *until}) : std::nullopt;
}

Nights::Night Nights::night(Date date) const {
    const Whereabouts& here = place_.whereabouts;
    Night night{.date = date, .sunset = {}, .sunrise = {}, .moments = {}, .remarks = {}};
    night.sunset = NightTime{SunEvent::Sunset}.in(date, here);
    night.sunrise = NightTime{SunEvent::Sunrise}.in(date, here);
    const auto remark = [&](std::string text) {
        if (std::ranges::find(night.remarks, text) == night.remarks.end()) night.remarks.push_back(std::move(text));
    };
    if ((schedule_.first && date < *schedule_.first) || (schedule_.last && date > *schedule_.last)) {
        remark("out of season");
        return night;
    }
    if (std::ranges::find(schedule_.dark, date) != schedule_.dark.end()) {
        remark("dark");
        return night;
    }
    const auto allowed = allowedIn(date);
    struct Plays {
        Interval when;
        int cue;
    };
    std::vector<Plays> plays;
    for (const Schedule::Item& item : schedule_.items) {
        if (!isOn(item.on, date)) continue;
        const auto from = item.from.in(date, here);
        const auto until = item.until ? item.until->in(date, here) : std::optional(here.noonOf(next(date)));
        if (!from) remark(fmt::format("no {}", kSunEvents[static_cast<std::size_t>(*item.from.event)]));
        if (!until) remark(fmt::format("no {}", kSunEvents[static_cast<std::size_t>(*item.until->event)]));
        if (!from || !until) continue;
        const Interval wanted{*from, *until};
        if (wanted.from >= wanted.until) remark("a cue would end before it begins");
        if (!allowed) remark("light is not allowed");
        if (wanted.from >= wanted.until || !allowed) continue;
        const Interval left{std::max(wanted.from, allowed->from), std::min(wanted.until, allowed->until)};
        if (left.from > wanted.from || (item.until && left.until < wanted.until)) remark("cut to the allowed hours");
        if (left.from < left.until) plays.push_back({left, static_cast<int>(item.cue)});
    }
    std::ranges::stable_sort(plays, {}, [](const Plays& each) { return each.when.from; });
    for (std::size_t i = 0; i < plays.size(); ++i) {
        const Time end = plays[i].when.until;
        if (i + 1 < plays.size() && plays[i + 1].when.from == plays[i].when.from) continue;  // the later line counts
        night.moments.push_back({plays[i].when.from, plays[i].cue});
        if (i + 1 == plays.size() || plays[i + 1].when.from > end) night.moments.push_back({end, kDark});
    }
    return night;
}

Nights::Stretch Nights::stretchAt(Time utc) const {
    const Date date = nightAt(utc);
    const Whereabouts& here = place_.whereabouts;
    Stretch stretch{{here.noonOf(date), kDark}, here.noonOf(next(date))};
    for (const Moment& moment : night(date).moments) {
        if (moment.utc > utc) {
            stretch.end = moment.utc;
            break;
        }
        stretch.begin = moment;
    }
    return stretch;
}

std::optional<Nights::Moment> Nights::after(Time utc) const {
    Date date = nightAt(utc);
    for (int nights = 0; nights <= kYear; ++nights, date = next(date))
        for (const Moment& moment : night(date).moments)
            if (moment.utc > utc) return moment;
    return std::nullopt;
}

std::vector<Nights::Moment> Nights::between(Time utc, Time end) const {
    std::vector<Moment> moments;
    for (Date date = nightAt(utc); place_.whereabouts.noonOf(date) <= end; date = next(date))
        for (const Moment& moment : night(date).moments)
            if (moment.utc > utc && moment.utc <= end) moments.push_back(moment);
    return moments;
}

std::optional<Nights::Night> Nights::nextFrom(Date date) const {
    for (int nights = 0; nights <= kYear; ++nights, date = next(date))
        if (Night found = night(date); !found.moments.empty()) return found;
    return std::nullopt;
}

}  // namespace fantascope::show
