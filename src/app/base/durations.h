#pragma once

#include "core/clock.h"

#include <array>
#include <cstdint>

namespace fantascope::app {

// A histogram of durations. Its bins are 1 % wide, from a microsecond to a quarter of an hour, so a
// night takes no more memory than a minute. Adding never allocates. Thread: thread-bound.
class Durations {
public:
    void add(Time duration);

    std::uint64_t count() const { return count_; }
    // The p-quantile (nearest rank) in milliseconds, accurate to 1 %; 0 if there are no durations.
    // 0 < p <= 1.
    double quantileMs(double p) const;
    double maxMs() const { return seconds(max_) * 1e3; }  // exact

private:
    static constexpr double kStep = 1.01;
    static constexpr std::size_t kBins = 2080;  // ln(9e8 us) / ln(kStep) and some
    std::array<std::uint64_t, kBins> bins_{};
    std::uint64_t count_ = 0;
    Time max_{};
};

}  // namespace fantascope::app
