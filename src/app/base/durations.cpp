#include "app/base/durations.h"

#include <algorithm>
#include <cmath>

namespace fantascope::app {

void Durations::add(Time duration) {
    const double microseconds = std::max(1.0, static_cast<double>(duration.count()) * 1e-3);
    const auto bin = static_cast<std::size_t>(std::log(microseconds) / std::log(kStep));
    ++bins_[std::min(bin, kBins - 1)];
    ++count_;
    max_ = std::max(max_, duration);
}

double Durations::quantileMs(double p) const {
    const auto rank = static_cast<std::uint64_t>(std::ceil(p * static_cast<double>(count_)));
    std::uint64_t below = 0;
    for (std::size_t bin = 0; bin < kBins; ++bin) {
        below += bins_[bin];
        // The bin's middle, but never more than what was really seen.
        if (below >= rank && below > 0) return std::min(std::pow(kStep, static_cast<double>(bin) + 0.5) * 1e-3, maxMs());
    }
    return 0;
}

}  // namespace fantascope::app
