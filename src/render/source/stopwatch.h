#pragma once

#include "core/clock.h"

namespace fantascope::render {

// Adds up the time that some of the work takes. Thread: thread-bound.
class Stopwatch {
public:
    // Without a clock nothing is measured. The clock outlives it.
    explicit Stopwatch(const Clock* clock) : clock_(clock) {}

    void time(auto work) {
        const Time began = now();
        work();
        sum_ += now() - began;
    }
    void reset() { sum_ = Time{}; }
    // What was added up since the last reset().
    Time sum() const { return sum_; }

private:
    Time now() const { return clock_ != nullptr ? clock_->now() : Time{}; }

    const Clock* clock_;
    Time sum_{};
};

}  // namespace fantascope::render
