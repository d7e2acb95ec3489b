#pragma once

#include "core/clock.h"

#include <optional>

namespace fantascope::drivers {

// The pauses between failing attempts: short at first, then doubled each time up to a limit. A
// success that ends within that limit does not reset the pauses. Thread: thread-bound.
class BackOff {
public:
    // Defaults for a device on a shared line. Short enough that a device that is back, and whose
    // first answer got lost, is found within 2 s. Long enough that a dead device leaves more than
    // half of the line's time to the others.
    static constexpr Time kMinPause = std::chrono::milliseconds(50), kMaxPause = std::chrono::milliseconds(400);

    explicit BackOff(Time minPause = kMinPause, Time maxPause = kMaxPause) : minPause_(minPause), maxPause_(maxPause) {}

    void succeeded(Time now) { succeeded_ = now; }  // an attempt has succeeded
    Time failed(Time now);                          // the pause until the next attempt

private:
    Time minPause_, maxPause_;
    std::optional<Time> succeeded_;  // when the current success began
    Time pause_{};
};

}  // namespace fantascope::drivers
