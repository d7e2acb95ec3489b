#pragma once

#include "show/course/course.h"

#include "core/clock.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace fantascope::show {

// A source's own time, by which it plays. It goes by as fast as cue time, or at a speed of its own:
// faster, slower, or not at all. The own time is the integral of the speed, so it never jumps, also
// while the speed changes. Value type; thread: reentrant.
class PlayCourse {
public:
    // A source that plays as fast as cue time.
    PlayCourse() = default;
    // From `at` on, the speed moves to `speed`, 0 or more, within `length`.
    PlayCourse moved(float speed, Time at, Time length, Curve curve) const {
        return {{speedAt(at), speed, at, length, curve}, behindAt(at)};
    }
    // From `at` on, the speed is `speed`.
    PlayCourse at(float speed, Time at) const { return {{speed, speed, at, Time{}}, behindAt(at)}; }

    float speedAt(Time time) const { return speed_.valueAt(time); }
    // The speed in the end.
    float lastSpeed() const { return speed_.to; }
    Time ownTime(Time time) const { return time - behindAt(time); }
    // By how much the own time is behind cue time `time`; negative: ahead of it. Before the last
    // change it is as if the new speed had always been.
    Time behindAt(Time time) const {
        const Time changed = std::clamp(time - speed_.start, Time{}, speed_.length);
        Time lost{};
        if (changed > Time{}) {
            const double length = seconds(speed_.length), share = seconds(changed) / length;
            lost = changed -
                   fromSeconds(length * (share * speed_.from + areaAlong(speed_.curve, share) * (speed_.to - speed_.from)));
        }
        return behind_ + lost + scaled(time - speed_.start - changed, 1.0 - static_cast<double>(speed_.to));
    }
    // When the own time is `own`, but no earlier than `from`; nothing: the source comes to stand
    // before.
    std::optional<Time> whenIs(Time own, Time from) const {
        if (ownTime(from) >= own) return from;
        Time before = from, after = std::max(from, speed_.start + speed_.length);
        if (const Time rest = own - ownTime(after); rest > Time{})
            return speed_.to > 0 ? std::optional(after + scaled(rest, 1 / static_cast<double>(speed_.to))) : std::nullopt;
        while (after - before > Time(1)) {  // while the speed changes
            const Time middle = before + (after - before) / 2;
            (ownTime(middle) < own ? before : after) = middle;
        }
        return after;
    }

private:
    PlayCourse(const Course& speed, Time behind) : speed_(speed), behind_(behind) {}
    static Time scaled(Time time, double factor) { return Time(std::llround(static_cast<double>(time.count()) * factor)); }

    Course speed_ = Course::at(1);
    Time behind_{};  // at the start of the last change
};

}  // namespace fantascope::show
