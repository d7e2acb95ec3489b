#pragma once

#include "core/clock.h"

#include <optional>

namespace fantascope::app {

// Tells which presses come too late to be wanted: the thread that takes them, or the whole machine,
// was busy. Thread: one at a time.
class Lateness {
public:
    static constexpr Time kTooLate = std::chrono::milliseconds(500);

    // At the beginning of each look for presses.
    void look(Time moment) {
        isAfterGap_ = moment_ && moment - *moment_ > kTooLate;
        moment_ = moment;
    }
    // Whether a press that this look has found, of moment `at`, is too late. After a gap all are:
    // what has come through a machine that stood still has the wrong moment.
    bool isLate(Time at) const { return isAfterGap_ || (moment_ && *moment_ - at > kTooLate); }

private:
    std::optional<Time> moment_;
    bool isAfterGap_ = false;
};

}  // namespace fantascope::app
