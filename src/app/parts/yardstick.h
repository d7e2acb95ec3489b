#pragma once

#include "app/parts/part.h"

#include "core/clock.h"

#include <cstdint>

namespace fantascope::app {

// Measures what the machine itself misses: a part with the render thread's rank that does nothing.
// If its ticks are late, the machine is the cause.
// Thread: tick() on its part's thread; the rest once the part has ended.
class Yardstick {
public:
    // `rate`: Hz, that of the frames.
    Yardstick(double rate, Time runStart) : rate_(rate), runStart_(runStart) {}

    Part part() {
        return {"yardstick", rate_, runStart_, [this](Time moment) { tick(moment); }, Rank::Render};
    }
    std::int64_t ticks() const { return ticks_; }
    std::int64_t late() const { return late_; }

private:
    void tick(Time moment) {
        const std::int64_t number = tickAt(moment - runStart_, rate_);
        late_ += number - last_ - 1;
        ++ticks_;
        last_ = number;
    }

    const double rate_;
    const Time runStart_;
    std::int64_t last_ = -1, ticks_ = 0, late_ = 0;
};

}  // namespace fantascope::app
