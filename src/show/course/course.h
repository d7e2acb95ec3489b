#pragma once

#include "core/clock.h"

#include <cmath>

namespace fantascope::show {

// How a value moves from one to another.
enum class Curve {
    Linear,
    Smooth,     // begins and ends at rest: 3 s^2 - 2 s^3 of the share s of its time
    SlowStart,  // begins at rest: s^2
    SlowEnd     // ends at rest: s (2 - s)
};

// How much of a change has happened after the share `s`, 0..1, of its time.
constexpr float along(Curve curve, float s) {
    switch (curve) {
        case Curve::Linear:
            break;
        case Curve::Smooth:
            return s * s * (3 - 2 * s);
        case Curve::SlowStart:
            return s * s;
        case Curve::SlowEnd:
            return s * (2 - s);
    }
    return s;
}

// The integral of along() from 0 to `s`.
constexpr double areaAlong(Curve curve, double s) {
    switch (curve) {
        case Curve::Linear:
            break;
        case Curve::Smooth:
            return s * s * s * (1 - s / 2);
        case Curve::SlowStart:
            return s * s * s / 3;
        case Curve::SlowEnd:
            return s * s * (1 - s / 3);
    }
    return s * s / 2;
}

// The course of one value in time: it is `from` until `start`, and `to` from `start` + `length` on.
// Value type; thread: reentrant.
struct Course {
    float from = 0, to = 0;
    Time start{}, length{};
    Curve curve = Curve::Linear;

    // A value that does not change.
    static Course at(float value) { return {value, value}; }

    // How much of the change has happened by `time`, 0..1, before the curve.
    float shareAt(Time time) const {
        if (time - start >= length) return 1;
        if (time <= start) return 0;
        return static_cast<float>(seconds(time - start) / seconds(length));
    }
    float valueAt(Time time) const { return std::lerp(from, to, along(curve, shareAt(time))); }
    // Whether it is anything but 0 at `time` or later.
    bool isSeenFrom(Time time) const { return to != 0 || (from != 0 && time - start < length); }
    friend bool operator==(const Course&, const Course&) = default;
};

}  // namespace fantascope::show
