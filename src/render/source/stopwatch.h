#pragma once

#include "core/clock.h"

namespace fantascope::render {

// Accumulates the time that pieces of work take. Thread: thread-bound.
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
    // Since the last reset().
    Time sum() const { return sum_; }

private:
    Time now() const { return clock_ != nullptr ? clock_->now() : Time{}; }

    const Clock* clock_;
    Time sum_{};
};

}  // namespace fantascope::render
