#include "pattern/search/pixel_mask.h"

#include <algorithm>
#include <bit>
#include <limits>

namespace fantascope::pattern {
namespace {

std::size_t index(int value) { return static_cast<std::size_t>(value); }

}  // namespace

void PixelMask::draw(SilhouetteScanner& scanner, const Silhouette& shape, const InstancePose& pose) {
    runs_.clear();
    int begin = std::numeric_limits<int>::max(), end = 0;
    scanner.scan(shape, pose, [&](int y, int from, int to) {
        runs_.push_back({y, from, to});
        begin = std::min(begin, from);
        end = std::max(end, to);
    });
    clear();
    if (runs_.empty()) return;
    left_ = begin / kBits, right_ = (end - 1) / kBits + 1;
    top_ = runs_.front().y, bottom_ = runs_.back().y + 1;
    const auto rows = index(bottom_ - top_);
    words_.assign(index(right_ - left_) * rows, 0);
    for (const Run& run : runs_) {
        const int last = (run.end - 1) / kBits;
        for (int column = run.begin / kBits; column <= last; ++column) {
            const int first = column * kBits;
            std::uint64_t mask = ~std::uint64_t{0};
            if (run.begin > first) mask <<= run.begin - first;
            if (run.end < first + kBits) mask &= (std::uint64_t{1} << (run.end - first)) - 1;
            words_[index(column - left_) * rows + index(run.y - top_)] |= mask;
        }
    }
}

std::int64_t PixelMask::count() const {
    std::int64_t count = 0;
    if (!empty())
        for (std::size_t i = 0; i < index(right_ - left_) * index(bottom_ - top_); ++i) count += std::popcount(words_[i]);
    return count;
}

glm::ivec2 PixelMask::randomPixel(Rng& rng) const {
    auto left = static_cast<int>(rng.below(static_cast<std::uint32_t>(count())));
    for (int at = left_;; ++at)
        for (int y = top_; y < bottom_; ++y) {
            std::uint64_t bits = column(at).at(y);
            if (const int here = std::popcount(bits); here <= left) {
                left -= here;
                continue;
            }
            for (; left > 0; --left) bits &= bits - 1;
            return {at * kBits + std::countr_zero(bits), y};
        }
}

}  // namespace fantascope::pattern
