#pragma once

#include "core/clock.h"

#include <algorithm>
#include <chrono>
#include <optional>

namespace fantascope::app {

// A finished frame waits before it goes to its display, so that an input that comes meanwhile is
// still seen in it. This says for how long.
class HeldFrame {
public:
    // Notes how long it took to draw a frame.
    void drawn(Time took) {
        // After a GO there is more to draw than before: two looks instead of one. A frame that took
        // much longer than that was held up by the machine, and says nothing.
        constexpr int kMore = 3, kForgets = 1024;
        longest_ = std::max(std::min(took, kMore * mean_), longest_ - longest_ / kForgets);
        deviation_ += (std::chrono::abs(took - mean_) - deviation_) / 16;
        mean_ += (took - mean_) / 8;
    }
    // Until when a frame for the refresh at `due` waits, so that it can be drawn again. Nothing: it
    // goes at once, since drawing takes too long.
    std::optional<Time> until(Time due, Time period) const {
        // Shares of a period: the frame goes that long before its refresh, or earlier; drawing it
        // again may take that long, or less. The next frame is begun when this one goes, so it has
        // more than a period.
        constexpr double kAtLeast = 0.4, kAtMost = 0.65;
        if (again() > fromSeconds(kAtMost * seconds(period))) return std::nullopt;
        return due - std::max(again() + kWakes, fromSeconds(kAtLeast * seconds(period)));
    }
    // How long it may take to draw a frame again. Estimated as a network estimates how long an
    // answer may take: from the mean and the mean deviation (Jacobson 1988); but as long as it took
    // lately at least.
    Time again() const { return std::max(mean_ + 4 * deviation_, longest_) + kWakes; }

private:
    static constexpr Time kWakes = std::chrono::milliseconds(1);  // so late a thread may wake

    Time mean_{}, deviation_{}, longest_{};
};

}  // namespace fantascope::app
