#include "pattern/running_score.h"

#include "core/check.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <utility>

namespace fantascope::pattern {
namespace {

constexpr int kBlocksOfHeight = 45;

int blockSide(int height) { return std::max(1, static_cast<int>(std::lround(double(height) / kBlocksOfHeight))); }

std::size_t cell(std::int32_t index) { return static_cast<std::size_t>(index); }

}  // namespace

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

void LayerCounts::take(std::size_t word, std::uint64_t mask) {
    for (std::size_t plane = 0; mask != 0; ++plane) {
        FANTASCOPE_CHECK(plane < planes_.size(), "only what lies on a pixel is taken from it");
        std::uint64_t& bits = planes_[plane][word];
        const std::uint64_t borrow = ~bits & mask;
        bits ^= mask;
        mask = borrow;
    }
}

RunningScore::RunningScore(const SearchSpace& space)
    : space_(space),
      width_(space.pixels().x),
      height_(space.pixels().y),
      block_(blockSide(height_)),
      blocks_((width_ + block_ - 1) / block_ + 1, (height_ + block_ - 1) / block_ + 1),
      counts_(wordAt(width_ - 1, height_ - 1) + 1),
      costs_(wordAt(width_ - 1, height_ - 1) + 1),
      columnOf_(static_cast<std::size_t>(width_)),
      columnEnds_(static_cast<std::size_t>(blocks_.x)),
      rowOf_(static_cast<std::size_t>(height_)),
      sum_(space.goal().allBlack()),
      blockChange_(static_cast<std::size_t>(blocks_.x) * static_cast<std::size_t>(blocks_.y), 0) {
    for (Scale& scale : scales_) scale.cellOf.assign(blockChange_.size(), 0);
    for (int first = 0; first < width_; first += LayerCounts::kBits)
        for (int y = 0; y < height_; ++y)
            for (int i = 0; i <= LayerCounts::kBits; ++i)
                costs_[wordAt(first, y)][cell(i)] =
                    static_cast<std::int32_t>(space.goal().cost(y, first, std::min(first + i, width_)));
}

std::size_t RunningScore::wordAt(int x, int y) const {
    return static_cast<std::size_t>(x / LayerCounts::kBits) * static_cast<std::size_t>(height_) + static_cast<std::size_t>(y);
}

void RunningScore::jitter(Rng& rng) {
    const auto below = [&](int count) { return static_cast<int>(rng.below(static_cast<std::uint32_t>(count))); };
    const int left = below(block_), top = below(block_);
    for (int x = 0; x < width_; ++x) columnOf_[cell(x)] = (x + left) / block_;
    for (int column = 0; column < blocks_.x; ++column) columnEnds_[cell(column)] = (column + 1) * block_ - left;
    for (int y = 0; y < height_; ++y) rowOf_[cell(y)] = (y + top) / block_ * blocks_.x;

    // What each block lacks.
    std::vector<std::int64_t> lack(blockChange_.size(), 0);
    for (int y = 0; y < height_; ++y)
        for (int column = 0; column < blocks_.x; ++column) {
            const int begin = std::max(0, columnEnds_[cell(column)] - block_), end = std::min(width_, columnEnds_[cell(column)]);
            if (begin < end) lack[cell(rowOf_[cell(y)] + column)] += space_.goal().guideSum({{begin, y}, {end, y + 1}});
        }
    for (int y = 0; y < height_; ++y)
        for (int first = 0; first < width_; first += LayerCounts::kBits) {
            const std::size_t word = wordAt(first, y);
            const int rest = width_ - first;
            std::uint64_t pixels = ~counts_.none(word);
            if (rest < LayerCounts::kBits) pixels &= (std::uint64_t{1} << rest) - 1;
            for (; pixels != 0; pixels &= pixels - 1)
                lack[cell(rowOf_[cell(y)] + columnOf_[cell(first + std::countr_zero(pixels))])] -= Goal::kWhite;
        }
    for (std::size_t s = 0; s < scales_.size(); ++s) {
        Scale& scale = scales_[s];
        const int side = kScales[s];
        const glm::ivec2 shift(below(side), below(side));
        const int columns = (blocks_.x + shift.x - 1) / side + 1, rows = (blocks_.y + shift.y - 1) / side + 1;
        scale.lack.assign(cell(columns * rows), 0);
        scale.change.assign(scale.lack.size(), 0);
        scale.touchedIn.assign(scale.lack.size(), 0);
        std::size_t block = 0;
        for (int y = 0; y < blocks_.y; ++y)
            for (int x = 0; x < blocks_.x; ++x, ++block) {
                scale.cellOf[block] = (y + shift.y) / side * columns + (x + shift.x) / side;
                scale.lack[cell(scale.cellOf[block])] += lack[block];
            }
    }
}

// Calls use(word, mask, y, x of the word's first pixel) for the words of the runs.
template <class Use>
void RunningScore::forEachWord(const PixelRuns& runs, Use use) {
    constexpr int kBits = LayerCounts::kBits;
    for (const PixelRun& run : runs) {
        const int last = (run.end - 1) / kBits;
        for (int i = run.begin / kBits; i <= last; ++i) {
            const int first = i * kBits;
            std::uint64_t mask = ~std::uint64_t{0};
            if (run.begin > first) mask <<= run.begin - first;
            if (run.end < first + kBits) mask &= (std::uint64_t{1} << (run.end - first)) - 1;
            use(wordAt(first, run.y), mask, run.y, first);
        }
    }
}

// What covering these pixels of a word adds to the sum.
std::int64_t RunningScore::costOf(std::size_t word, std::uint64_t pixels) const {
    const std::array<std::int32_t, LayerCounts::kBits + 1>& costs = costs_[word];
    std::int64_t cost = 0;
    while (pixels != 0) {
        const int begin = std::countr_zero(pixels), end = begin + std::countr_one(pixels >> begin);
        cost += costs[cell(end)] - costs[cell(begin)];
        if (end == LayerCounts::kBits) break;
        pixels &= ~std::uint64_t{0} << end;
    }
    return cost;
}

// These pixels of a word become covered (sign 1) or free (-1).
void RunningScore::noteCovered(std::size_t word, int y, int first, std::uint64_t pixels, int sign) {
    if (pixels == 0) return;
    sumChange_ += sign * costOf(word, pixels);
    const std::int32_t row = rowOf_[cell(y)];
    while (pixels != 0) {
        const std::int32_t column = columnOf_[cell(first + std::countr_zero(pixels))];
        const int end = columnEnds_[cell(column)] - first;
        const std::uint64_t here = end < LayerCounts::kBits ? pixels & ((std::uint64_t{1} << end) - 1) : pixels;
        const int count = sign * std::popcount(here);
        std::int32_t& change = blockChange_[cell(row + column)];
        if (change == 0) touchedBlocks_.push_back(row + column);
        change += count;
        pixels ^= here;
    }
}

double RunningScore::propose(const PixelRuns& out, const PixelRuns& in) {
    ++move_;
    sumChange_ = 0;
    std::int64_t several = 0;
    forEachWord(out, [&](std::size_t word, std::uint64_t mask, int y, int first) {
        const std::uint64_t freed = counts_.one(word) & mask;
        several -= std::popcount(counts_.two(word) & mask);
        counts_.take(word, mask);
        noteCovered(word, y, first, freed, -1);
    });
    forEachWord(in, [&](std::size_t word, std::uint64_t mask, int y, int first) {
        several += std::popcount(counts_.one(word) & mask);
        noteCovered(word, y, first, counts_.none(word) & mask, 1);
    });
    const PatternSearch::Options::Refined& weights = space_.options().refined;
    return (weights.zWeight * static_cast<double>(sumChange_) + weights.toneWeight * toneChange()) / Goal::kWhite +
           weights.overlapWeight * static_cast<double>(several);
}

// Brings the move's changes from the blocks to the cells.
double RunningScore::toneChange() {
    for (const std::int32_t block : touchedBlocks_) {
        const std::int32_t pixels = std::exchange(blockChange_[cell(block)], 0);
        if (pixels == 0) continue;
        for (Scale& scale : scales_) {
            const std::int32_t here = scale.cellOf[cell(block)];
            if (std::exchange(scale.touchedIn[cell(here)], move_) != move_) scale.touched.push_back(here);
            scale.change[cell(here)] += pixels;
        }
    }
    touchedBlocks_.clear();
    std::int64_t change = 0;
    for (const Scale& scale : scales_)
        for (const std::int32_t here : scale.touched) {
            const std::int64_t lack = scale.lack[cell(here)];
            change += std::abs(lack - std::int64_t{Goal::kWhite} * scale.change[cell(here)]) - std::abs(lack);
        }
    return static_cast<double>(change) / static_cast<double>(scales_.size());
}

void RunningScore::accept(const PixelRuns& in) {
    forEachWord(in, [&](std::size_t word, std::uint64_t mask, int, int) { counts_.add(word, mask); });
    sum_ += sumChange_;
    for (Scale& scale : scales_) {
        for (const std::int32_t here : scale.touched)
            scale.lack[cell(here)] -= std::int64_t{Goal::kWhite} * std::exchange(scale.change[cell(here)], 0);
        scale.touched.clear();
    }
}

void RunningScore::reject(const PixelRuns& out) {
    forEachWord(out, [&](std::size_t word, std::uint64_t mask, int, int) { counts_.add(word, mask); });
    for (Scale& scale : scales_) {
        for (const std::int32_t here : scale.touched) scale.change[cell(here)] = 0;
        scale.touched.clear();
    }
}

double RunningScore::z() const { return static_cast<double>(sum_) / (static_cast<double>(Goal::kWhite) * width_ * height_); }

bool RunningScore::lacksLight(glm::ivec2 pixel) const {
    const std::size_t word = wordAt(pixel.x, pixel.y);
    if ((counts_.none(word) >> (pixel.x % LayerCounts::kBits) & 1) == 0) return false;
    const Scale& scale = scales_[0];
    return scale.lack[cell(scale.cellOf[cell(rowOf_[cell(pixel.y)] + columnOf_[cell(pixel.x)])])] > 0;
}

}  // namespace fantascope::pattern
