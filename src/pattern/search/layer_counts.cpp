#include "pattern/search/layer_counts.h"

#include "core/check.h"

namespace fantascope::pattern {

LayerCounts::LayerCounts(std::size_t words) : planes_(2, std::vector<std::uint64_t>(words, 0)) {}

void LayerCounts::add(std::size_t word, std::uint64_t mask) {
    for (std::size_t plane = 0; mask != 0; ++plane) {
        FANTASCOPE_CHECK(plane < kPlanes, "fewer than 65536 instances lie on a pixel");
        if (plane == planes_.size()) planes_.emplace_back(planes_[0].size(), 0);
        std::uint64_t& bits = planes_[plane][word];
        const std::uint64_t carry = bits & mask;
        bits ^= mask;
        mask = carry;
    }
}

void LayerCounts::remove(std::size_t word, std::uint64_t mask) {
    for (std::size_t plane = 0; mask != 0; ++plane) {
        FANTASCOPE_CHECK(plane < planes_.size(), "an instance that is removed from a pixel lies on it");
        std::uint64_t& bits = planes_[plane][word];
        const std::uint64_t borrow = ~bits & mask;
        bits ^= mask;
        mask = borrow;
    }
}

}  // namespace fantascope::pattern
