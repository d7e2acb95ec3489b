#pragma once

#include "core/clock.h"

#include <cstddef>

namespace fantascope::app {

// The schedule by which a rehearsal without an operator presses GO: once for each cue that is to be
// entered, so that every cue gets an equal share of the length. The first press comes after a short
// darkness, or, if a cue is on from the start, after that cue's share.
class GoSchedule {
public:
    GoSchedule(std::size_t presses, bool cueIsOn, Time length) : presses_(presses), cueIsOn_(cueIsOn), length_(length) {}
    // Whether the next press is due. Returns true once for each press.
    bool due(Time runTime);
    // The run time of the next press; Time::max() if there is none.
    Time next() const;
    void end() { pressed_ = presses_; }  // for when the operator takes over
    bool ended() const { return pressed_ == presses_; }

private:
    std::size_t presses_, pressed_ = 0;
    bool cueIsOn_;
    Time length_;
};

}  // namespace fantascope::app
