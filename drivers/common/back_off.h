#pragma once

#include "core/clock.h"

#include <optional>

namespace fantascope::drivers {

// The pauses between attempts that fail: the first soon, then each twice as long, up to a limit.
// What succeeds and fails again within that limit counts as never succeeded. Thread: thread-bound.
class BackOff {
public:
    // Of a device on a line: so short that one which is there again and whose first answer got lost
    // is still found within 2 s, so long that a dead one leaves more than half of the line to the
    // others.
    static constexpr Time kSoonest = std::chrono::milliseconds(50), kLatest = std::chrono::milliseconds(400);

    explicit BackOff(Time soonest = kSoonest, Time latest = kLatest) : soonest_(soonest), latest_(latest) {}

    void began(Time now) { began_ = now; }  // it has succeeded
    Time failed(Time now);                  // the pause until the next attempt

private:
    Time soonest_, latest_;
    std::optional<Time> began_;  // since when it succeeds
    Time pause_{};
};

}  // namespace fantascope::drivers
