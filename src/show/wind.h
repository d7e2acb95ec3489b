#pragma once

#include "core/clock.h"
#include "core/wind.h"

#include <array>
#include <cstdint>
#include <optional>

namespace fantascope::show {

// The wind that a look asks for on one output.
struct WindWish {
    double strength = 1;  // that of the strongest gust; 0 .. 4, 1 is what the patterns were made for
    double gusts = 0;     // 0..1: the share of the strength that comes and goes
    // Radians from the canvas's x axis towards its y axis; without it each pattern has its own.
    std::optional<double> direction = std::nullopt;
};

// The slow come and go of gusts: a sum of waves whose phases come from a random stream of their
// own. It has neither a beginning nor an end nor a period that anybody could notice. Thread:
// reentrant.
class Gusts {
public:
    explicit Gusts(std::uint64_t seed);

    // How far the wind has dropped: 0 is the strongest gust, 1 the deepest lull. Smooth in time.
    double lullAt(Time time) const;

private:
    struct Wave {
        double amplitude;         // all together 1
        double angularFrequency;  // radians a second
        double phase;             // radians
    };
    std::array<Wave, 4> waves_;
};

// The wind on one output from one cue to the next. What is asked for moves linearly in the cue's
// fade, as levels do; the wind follows it through two lags of half a second each, for air has
// inertia: neither the wind nor its rate of change ever jumps, not even at a cue without a fade or
// in the middle of another one. A lag is a weighted mean of what was asked for so far, so the wind
// never overshoots. A direction is a vector here: from 359 to 1 degrees it hardly moves, and to
// turn back the wind dies down first. Thread: reentrant.
class WindCourse {
public:
    // As if `wish` had been asked for since ever.
    explicit WindCourse(const WindWish& wish);
    // Leaves this course at `start` for `wish`, which is asked for whole at start + fade.
    WindCourse(const WindCourse& before, const WindWish& wish, Time start, Time fade);

    // At `time` >= start; `lull` is Gusts::lullAt then.
    Wind at(Time time, double lull) const;

private:
    // strength, gusts, ownDirection, direction x, direction y
    using Values = std::array<double, 5>;
    struct State {
        Values asked, first, second;  // what the cues ask for, after one lag, and after both
    };
    static Values valuesOf(const WindWish& wish);
    State stateAt(Time time) const;

    Time start_{}, fade_{};
    State from_;     // at start_
    Values target_;  // asked for from start_ + fade_ on
};

}  // namespace fantascope::show
