#pragma once

#include "core/clock.h"

#include <algorithm>
#include <chrono>
#include <optional>

namespace fantascope::app {

// A finished frame waits before it goes to its display, so that an input that comes meanwhile is
// still seen in it. It goes this share of a period before its refresh, at the latest.
constexpr double kHeld = 0.4;

// Until when a frame for the refresh at `due` waits, if it takes `took` to draw it again. Nothing:
// it goes at once, since drawing takes more than half a period.
inline std::optional<Time> heldUntil(Time due, Time period, Time took) {
    constexpr Time kMargin = std::chrono::milliseconds(2);
    const Time again = took + took / 4 + kMargin;
    if (again > period / 2) return std::nullopt;
    return due - std::max(again, fromSeconds(kHeld * seconds(period)));
}

}  // namespace fantascope::app
