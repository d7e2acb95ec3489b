#pragma once

#include "show/schedule/place.h"
#include "show/schedule/schedule.h"

#include "core/clock.h"

#include <optional>
#include <string>
#include <vector>

namespace fantascope::show {

// What a show's schedule does at a place: which cue it enters when.
// A pure function of the time. Thread: any.
class Nights {
public:
    static constexpr int kDark = -1;
    // At `utc` the schedule enters a cue, or lets it get dark.
    struct Moment {
        Time utc{};
        int cue = kDark;
        friend bool operator==(const Moment&, const Moment&) = default;
    };
    struct Night {
        Date date;
        std::optional<Time> sunset, sunrise;  // UTC
        std::vector<Moment> moments;          // by time; the last one is dark. Empty: nothing plays
        std::vector<std::string> remarks;     // why less plays than is written
    };

    Nights(Schedule schedule, Place place) : schedule_(std::move(schedule)), place_(std::move(place)) {}

    const TimeZone& zone() const { return place_.whereabouts.zone; }
    Date nightAt(Time utc) const { return place_.whereabouts.nightAt(utc); }
    Night night(Date date) const;
    // The newest moment at `utc`. Before the first one of a night it is dark, since the noon.
    Moment at(Time utc) const { return stretchAt(utc).begin; }
    // From `begin` to `end` the schedule calls nothing.
    struct Stretch {
        Moment begin;
        Time end{};  // UTC
    };
    Stretch stretchAt(Time utc) const;
    // The first moment after `utc`, within a year.
    std::optional<Moment> after(Time utc) const;
    // The moments after `utc`, and until `end`.
    std::vector<Moment> between(Time utc, Time end) const;
    // The first night from `date` on in which something plays, within a year.
    std::optional<Night> nextFrom(Date date) const;

private:
    struct Interval {
        Time from, until;
    };
    std::optional<Interval> allowedIn(Date night) const;

    Schedule schedule_;
    Place place_;
};

}  // namespace fantascope::show
