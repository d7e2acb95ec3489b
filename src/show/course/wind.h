#pragma once

#include "core/clock.h"
#include "core/wind.h"

#include <array>
#include <cstdint>
#include <optional>

namespace fantascope::show {

// The wind that a look asks for on one output.
struct WindWish {
    double strength = 1;  // of the strongest gust, 0 .. 4; the patterns were made for 1
    double gusts = 0;     // 0..1: the share of the strength that comes and goes
    // Radians from the canvas's x axis towards its y axis; none: each pattern has its own
    // direction.
    std::optional<double> direction = std::nullopt;
};

// The slow rise and fall of gusts: a sum of waves whose phases come from a random stream of their
// own. It has no beginning, no end and no noticeable period. Thread: reentrant.
class Gusts {
public:
    explicit Gusts(std::uint64_t seed);

    // How far the wind has dropped: 0 is the strongest gust, 1 the deepest lull. Smooth in time.
    double lullAt(Time time) const;

private:
    struct Wave {
        double amplitude;         // the sum over all waves is 1
        double angularFrequency;  // radians a second
        double phase;             // radians
    };
    std::array<Wave, 4> waves_;
};

// The wind on one output from one cue to the next. The wanted wind moves linearly during the cue's
// fade, as levels do. The actual wind follows it through two lags of half a second each, because
// air has inertia. So neither the wind nor its rate of change ever jumps, not even at a cue without
// a fade or in the middle of another fade. A lag is a weighted mean of the wanted winds so far, so
// the wind never overshoots. A direction is a vector here: from 359 to 1 degrees it hardly moves,
// and before it turns back the wind dies down. Thread: reentrant.
class WindCourse {
public:
    // The course of a wind that has been wanted forever.
    explicit WindCourse(const WindWish& wish);
    // Leaves the course `before` at `start`. The wanted wind reaches `wish` at start + fade.
    WindCourse(const WindCourse& before, const WindWish& wish, Time start, Time fade);

    // The wind at `time` >= start; `lull` is Gusts::lullAt(time).
    Wind at(Time time, double lull) const;

private:
    // strength, gusts, ownDirection, direction x, direction y
    using Values = std::array<double, 5>;
    struct State {
        Values asked, first, second;  // the wanted wind, the wind after one lag, and after both
    };
    static Values valuesOf(const WindWish& wish);
    State stateAt(Time time) const;

    Time start_{}, fade_{};
    State from_;     // at start_
    Values target_;  // the wanted wind from start_ + fade_ on
};

}  // namespace fantascope::show
