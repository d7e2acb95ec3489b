#pragma once

#include "core/clock.h"

#include <cstddef>

namespace fantascope::app {

// When a rehearsal without hands presses GO, so that it reaches every cue in an equal share of its
// length: one press for each cue that is to be entered. The first comes after a moment of darkness,
// or, where a cue is on from the start, after that cue's share.
class GoSchedule {
public:
    GoSchedule(std::size_t presses, bool cueIsOn, Time length) : presses_(presses), cueIsOn_(cueIsOn), length_(length) {}
    // Whether the next press is due; each is so once.
    bool due(Time runTime);
    // The run time of the next press; Time::max() if none is to come.
    Time next() const;
    void end() { pressed_ = presses_; }  // the operator has taken over
    bool ended() const { return pressed_ == presses_; }

private:
    std::size_t presses_, pressed_ = 0;
    bool cueIsOn_;
    Time length_;
};

}  // namespace fantascope::app
