#pragma once

#include "show/course/steps.h"

#include "core/clock.h"

namespace fantascope::show {

// A factor of all light, 0..1. It moves to what is wanted at a constant rate, so that a reversal in
// the middle makes no step. A pure function of time and of the calls so far, whose times never
// decrease. Thread: const functions are reentrant.
class Dimmer {
public:
    // `fade`: how long the light would take from full to none.
    void want(float level, Time at, Time fade);
    float at(Time time) const;
    float wantedAt(Time time) const { return moves_.at(time).to; }
    void forget(Time time) { moves_.forget(time); }

private:
    struct Move {
        float from = 1, to = 1;
        Time start{}, fade{};
    };
    Steps<Move> moves_;
};

}  // namespace fantascope::show
