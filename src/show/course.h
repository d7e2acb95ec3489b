#pragma once

#include "core/clock.h"

#include <cmath>

namespace fantascope::show {

// How a value moves from one to another.
enum class Curve {
    Linear,
    Smooth  // begins and ends at rest: 3 s^2 - 2 s^3 of the share s of its time
};

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
    float valueAt(Time time) const {
        const float share = shareAt(time);
        return std::lerp(from, to, curve == Curve::Linear ? share : share * share * (3 - 2 * share));
    }
    friend bool operator==(const Course&, const Course&) = default;
};

}  // namespace fantascope::show
