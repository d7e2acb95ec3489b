#pragma once

#include "show/course/course.h"
#include "show/course/steps.h"

#include "core/clock.h"

#include <optional>
#include <vector>

namespace fantascope::show {

// By how much the site's own lamps give less than the cue asks, because other light lies on the
// wall. It concerns only the fixtures and relays that the site file lists for it.
struct LampTrim {
    float share = 1;    // of the fixtures' levels, 0..1
    int relaysOff = 0;  // so many of the relays are off, in the order of the list
    friend bool operator==(const LampTrim&, const LampTrim&) = default;
};

// The trim in time. The share moves from where it is to where it is wanted at a constant speed;
// relays switch at once. A pure function of time and of the calls so far, whose times never
// decrease. Thread: const functions are reentrant.
class TrimCourses {
public:
    // `speed`: of the share, 1/s.
    void want(const LampTrim& trim, Time at, double speed);
    // Gives all relays back to the cue; the share goes on.
    void releaseRelays(Time at);
    LampTrim at(Time time) const;
    void forget(Time time) { steps_.forget(time); }
    // When the number of relays that are off changed last; nothing: never.
    std::optional<Time> switched() const { return switched_; }

private:
    struct Step {
        Course share = Course::at(1);
        int relaysOff = 0;
    };
    void put(Time at, const Step& step);
    Steps<Step> steps_;
    std::optional<Time> switched_;
};

}  // namespace fantascope::show
