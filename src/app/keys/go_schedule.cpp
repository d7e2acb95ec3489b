#include "app/keys/go_schedule.h"

namespace fantascope::app {

Time GoSchedule::next() const {
    if (ended()) return Time::max();
    constexpr double kDarkness = 1.0 / 6;  // of a cue's share of the length
    const double share = seconds(length_) / (static_cast<double>(presses_) + (cueIsOn_ ? 1 : 0));
    return fromSeconds(share * (static_cast<double>(pressed_) + (cueIsOn_ ? 1 : kDarkness)));
}

bool GoSchedule::due(Time runTime) {
    if (runTime < next()) return false;
    ++pressed_;
    return true;
}

}  // namespace fantascope::app
