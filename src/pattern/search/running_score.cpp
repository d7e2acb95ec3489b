#include "pattern/search/running_score.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <utility>

namespace fantascope::pattern {
namespace {

// The finer Gaussian's sigma, and about the distance between its nodes, as shares of the height.
constexpr double kSigma = 1 / 36.0, kSpacing = 1 / 45.0;
// How far that distance may be off, so that more of a picture's blocks can be large.
constexpr double kSpacingTolerance = 0.125;
constexpr double kKernelSum = 1024;
// The kernel's least variance, for guides of a few rows: nearly no blur.
constexpr double kSharpest = 0.01;
// The guide counts as black or white within about this distance.
constexpr double kBinary = 0.02;
// The overlap counts a lighter guide as white: instances there have no room side by side.
constexpr double kWhite = 0.9;
// The weight of the edges of greys. At 1 they would be as sharp as those of black and white, and
// greys would become outlines.
constexpr double kEdges = 0.25;

// The number of set bits of each byte, in that byte.
std::uint64_t bitsOfBytes(std::uint64_t x) {
    x -= x >> 1 & 0x5555555555555555;
    x = (x & 0x3333333333333333) + (x >> 2 & 0x3333333333333333);
    return (x + (x >> 4)) & 0x0f0f0f0f0f0f0f0f;
}

std::size_t at(std::int32_t index) { return static_cast<std::size_t>(index); }

int blocksBetweenNodes(int block, int height) { return std::max(1, static_cast<int>(std::lround(kSpacing * height / block))); }

}  // namespace

// The largest side of a block with which the nodes have about their distance.
int RunningScore::blockFor(int height) {
    int block = kLargestBlock;
    const auto isFar = [&] {
        return std::abs(blocksBetweenNodes(block, height) * block / (kSpacing * height) - 1) > kSpacingTolerance;
    };
    while (block > 1 && isFar()) block /= 2;
    return block;
}

RunningScore::RunningScore(const SearchSpace& space)
    : space_(space),
      region_(space.options().region),
      width_(space.pixels().x),
      height_(space.pixels().y),
      block_(blockFor(height_)),
      blockShift_(std::countr_zero(static_cast<unsigned>(block_))),
      blocks_((width_ + block_ - 1) / block_, (height_ + block_ - 1) / block_),
      counts_(wordAt((width_ - 1) / PixelMask::kBits + 1, 0)),
      sum_(space.goal().allBlack()) {
    measureSurface();
    measureGuide();
    measureDetail();
}

// Fills lights_.
void RunningScore::measureSurface() {
    const Goal& goal = space_.goal();
    if (goal.isEven()) return;
    for (int row = 0; row < height_; row += block_)
        for (int column = 0; column < width_; column += block_) {
            const int bottom = std::min(row + block_, height_), right = std::min(column + block_, width_);
            double sum = 0;
            for (int y = row; y < bottom; ++y)
                for (int x = column; x < right; ++x) sum += goal.light(x, y);
            lights_.push_back(static_cast<std::int32_t>(std::lround(kLightSteps * sum / ((bottom - row) * (right - column)))));
        }
}

// Fills lack_ and each scale's `lack` for a black picture.
void RunningScore::measureGuide() {
    // The square of a node is a part of the blur. Integers, whose sum is exact.
    const double node = blocksBetweenNodes(block_, height_) * block_ / (kSigma * height_);  // in sigmas
    const double variance = std::max(kSharpest, 1 / (node * node) - 1 / 12.0);              // in nodes
    kernel_.fill(kKernelSum);
    double sum = 0;
    for (int i = -kReach; i <= kReach; ++i) sum += std::exp(-i * i / (2 * variance));
    for (int i = 1; i <= kReach; ++i) {
        const double value = std::round(kKernelSum * std::exp(-i * i / (2 * variance)) / sum);
        kernel_[at(kReach - i)] = kernel_[at(kReach + i)] = value;
        kernel_[at(kReach)] -= 2 * value;
    }
    for (int y = 0; y < blocks_.y; ++y)
        for (int x = 0; x < blocks_.x; ++x)
            lack_.push_back(kLightSteps *
                            space_.goal().guideSum({{x * block_, y * block_},
                                                    {std::min((x + 1) * block_, width_), std::min((y + 1) * block_, height_)}}));
    for (std::size_t s = 0; s < kScales; ++s) {
        Scale& scale = scales_[s];
        const int side = blocksBetweenNodes(block_, height_) << s;
        scale.nodes = (blocks_ + side - 1) / side;
        for (int x = 0; x < blocks_.x; ++x) scale.columns.push_back(x / side);
        for (int y = 0; y < blocks_.y; ++y) scale.rows.push_back(y / side);
        scale.lack.assign(at(scale.nodes.x) * at(scale.nodes.y), 0);
        scale.change.assign(scale.lack.size(), 0);
        std::size_t block = 0;
        for (int y = 0; y < blocks_.y; ++y)
            for (int x = 0; x < blocks_.x; ++x)
                scale.change[scale.at(scale.nodeOf({x, y}))] -=
                    static_cast<double>(lack_[block++]) / (kLightSteps * Goal::kWhite);
        Box all;
        all.add({0, 0}), all.add(scale.nodes - 1);
        spreadChange(scale, all);
        scale.lack.swap(scale.spread);
    }
}

// Fills words_ and pulls_ from the guide.
void RunningScore::measureDetail() {
    const Goal& goal = space_.goal();
    // The guide's mean around each node: the lack of a black picture divided by its lack if the
    // guide were white.
    Scale& scale = scales_[0];
    const std::vector<double> lack = scale.lack;
    for (int y = 0; y < height_; ++y)
        for (int x = 0; x < width_; ++x) scale.change[scale.at(scale.nodeOf(glm::ivec2(x, y) / block_))] -= 1;
    std::fill(scale.lack.begin(), scale.lack.end(), 0);
    scale.spread.clear();
    Box all;
    all.add({0, 0}), all.add(scale.nodes - 1);
    spreadChange(scale, all);
    scale.lack = lack;

    const auto pullAt = [&](int x, int y) {
        const double value = goal.value(x, y), light = goal.light(x, y);
        const auto costOf = [light](double wanted) { return wanted <= light ? light - 2 * wanted : -light; };
        const double grey = std::min(value, 1 - value) / kBinary;
        const double binary = grey > 4 ? 0 : std::exp(-grey * grey);
        const std::size_t node = scale.at(scale.nodeOf(glm::ivec2(x, y) / block_));
        const double cost = costOf(value), mean = costOf(lack[node] / scale.spread[node]);
        const double pull = binary * cost + kEdges * (1 - binary) * (cost - mean);
        return static_cast<int>(std::lround(kPull * std::clamp(pull, -1.0, 1.0)));
    };
    std::array<int, PixelMask::kBits> pulls{};
    for (int first = 0; first < width_; first += PixelMask::kBits)
        for (int y = 0; y < height_; ++y) {
            const int count = std::min(PixelMask::kBits, width_ - first);
            bool same = true;
            std::uint64_t white = 0;
            for (int i = 0; i < count; ++i) {
                if (goal.value(first + i, y) > kWhite) white |= std::uint64_t{1} << i;
                pulls[at(i)] = pullAt(first + i, y);
                same =
                    same && pulls[at(i)] == pulls[0] && goal.cost(y, first + i, first + i + 1) == goal.cost(y, first, first + 1);
            }
            const auto cost = static_cast<std::int32_t>(goal.cost(y, first, first + 1));
            words_.push_back(
                {~std::uint64_t{0}, 0, 0, white, pulls[0], cost, same ? -1 : static_cast<std::int32_t>(pulls_.size())});
            if (same) continue;
            auto& planes = pulls_.emplace_back();
            for (int i = 0; i < count; ++i)
                for (int plane = 0; plane < kPullPlanes; ++plane)
                    planes[at(plane)] |= static_cast<std::uint64_t>((pulls[at(i)] + kOffset) >> plane & 1) << i;
        }
}

// What covering these pixels of a word adds to the detail, in 1 / kPull.
std::int64_t RunningScore::pullOf(const Word& word, std::uint64_t pixels) const {
    if (word.pulls < 0) return std::int64_t{word.pull} * std::popcount(pixels);
    const auto& planes = pulls_[at(word.pulls)];
    std::int64_t sum = -std::int64_t{kOffset} * std::popcount(pixels);
    for (int plane = 0; plane < kPullPlanes; ++plane) sum += std::int64_t{std::popcount(planes[at(plane)] & pixels)} << plane;
    return sum;
}

// Notes the changed blocks in one column of words and one row of blocks. `covered` and `freed`: for
// blocks of 8, the number of pixels per block in its byte; for smaller blocks, the pixels
// themselves, of one row.
void RunningScore::noteBlocks(int column, int row, std::uint64_t covered, std::uint64_t freed, int part) {
    const std::uint64_t lane = ~std::uint64_t{0} >> (PixelMask::kBits - block_);
    const auto count = [&](std::uint64_t pixels) {
        return static_cast<std::int32_t>(block_ == kLargestBlock ? pixels & lane
                                                                 : static_cast<unsigned>(std::popcount(pixels & lane)));
    };
    // The words of the last column may extend beyond the picture's edge; their pixels do not.
    for (std::int32_t x = column * (PixelMask::kBits >> blockShift_); (covered | freed) != 0;
         ++x, covered >>= block_, freed >>= block_) {
        const std::int32_t pixels = count(covered) - count(freed);
        if (pixels == 0) continue;
        const std::int32_t light = lights_.empty() ? kLightSteps : lights_[at(row * blocks_.x + x)];
        blockChanges_.push_back({{x, row}, pixels * light, part});
    }
}

// Adds what replacing `out` by `in` changes in a window.
void RunningScore::compare(const PixelMask& out, const PixelMask& in, const Window& window, int part) {
    Change change;
    for (int column = window.left; column < window.right; ++column) {
        const PixelMask::Column outgoing = out.column(column), incoming = in.column(column);
        const Word* words = words_.data() + wordAt(column, 0);
        for (int y = window.top; y < window.bottom;) {
            std::uint64_t coveredOfBlocks = 0, freedOfBlocks = 0;
            const int row = y >> blockShift_;
            const int end = block_ == kLargestBlock ? std::min(window.bottom, (row + 1) * block_) : y + 1;
            for (; y < end; ++y) {
                const std::uint64_t before = outgoing.at(y), after = incoming.at(y);
                if (before == after) continue;
                const Word& word = words[y];
                const std::uint64_t comes = after & ~before, goes = before & ~after;
                const std::uint64_t second = word.one & comes, alone = word.two & goes;
                change.several += std::popcount(second) - std::popcount(alone);
                change.severalWhite += std::popcount(second & word.white) - std::popcount(alone & word.white);
                if (const std::uint64_t first = word.none & comes; first != 0) {
                    change.coveredWhite += std::popcount(first & word.white);
                    change.detail += pullOf(word, first);
                    coveredOfBlocks += block_ == kLargestBlock ? bitsOfBytes(first) : first;
                }
                if (const std::uint64_t freed = word.one & goes; freed != 0) {
                    change.coveredWhite -= std::popcount(freed & word.white);
                    change.detail -= pullOf(word, freed);
                    freedOfBlocks += block_ == kLargestBlock ? bitsOfBytes(freed) : freed;
                }
            }
            if ((coveredOfBlocks | freedOfBlocks) != 0) noteBlocks(column, row, coveredOfBlocks, freedOfBlocks, part);
        }
    }
    change_.detail += change.detail;
    change_.several += change.several;
    change_.coveredWhite += change.coveredWhite;
    change_.severalWhite += change.severalWhite;
}

double RunningScore::propose(const PixelMask& out, const PixelMask& in, double limit) {
    blockChanges_.clear();
    change_ = {};
    // A rectangle around masks far from each other would be mostly empty.
    const bool apart = out.empty() || in.empty() || out.right() <= in.left() || in.right() <= out.left() ||
                       out.bottom() <= in.top() || in.bottom() <= out.top();
    if (apart) {
        compare(out, in, {out.left(), out.right(), out.top(), out.bottom()}, 0);
        compare(out, in, {in.left(), in.right(), in.top(), in.bottom()}, 1);
    } else {
        compare(out, in,
                {std::min(out.left(), in.left()), std::max(out.right(), in.right()), std::min(out.top(), in.top()),
                 std::max(out.bottom(), in.bottom())},
                0);
    }
    const PatternSearch::Options::Refined& weights = space_.options().refined;
    const double others = weights.zWeight * static_cast<double>(change_.detail) / kPull + weights.overlapWeight * overlapChange();
    // Covering or freeing a pixel changes the tone by its light at most.
    Scale& finest = scales_[0];
    gather(finest);
    double pixels = 0;
    for (const Box& box : finest.touched)
        for (int y = box.low.y; y <= box.high.y; ++y)
            for (int x = box.low.x; x <= box.high.x; ++x) pixels += std::abs(finest.change[finest.at({x, y})]);
    const double lowerBound = others - weights.toneWeight * pixels;
    if (lowerBound <= limit) return others + weights.toneWeight * toneChange();
    for (const BlockChange& change : blockChanges_) finest.change[finest.at(finest.nodeOf(change.block))] = 0;
    return lowerBound;
}

double RunningScore::overlapChange() const {
    return static_cast<double>(change_.several - change_.severalWhite) +
           overlapAtWhite(coveredWhite_ + change_.coveredWhite, severalWhite_ + change_.severalWhite) -
           overlapAtWhite(coveredWhite_, severalWhite_);
}

double RunningScore::overlapAtWhite(std::int64_t coveredWhite, std::int64_t severalWhite) const {
    const double free = space_.options().refined.overlapFree * static_cast<double>(coveredWhite);
    return std::max(0.0, static_cast<double>(severalWhite) - free);
}

void RunningScore::gather(Scale& scale) {
    scale.touched = {};
    scale.spread.clear();
    for (const BlockChange& change : blockChanges_) {
        const glm::ivec2 node = scale.nodeOf(change.block);
        scale.change[scale.at(node)] += double(change.light) / kLightSteps;
        scale.touched[at(change.part)].add(node);
    }
}

// The change of the tone by the current move.
double RunningScore::toneChange() {
    double sum = 0;
    for (Scale& scale : scales_) {
        if (&scale != &scales_[0]) gather(scale);
        // Boxes whose changes reach the same nodes are merged.
        auto& [first, second] = scale.touched;
        if (!first.empty() && !second.empty() && glm::all(glm::lessThanEqual(first.low, second.high + 2 * kReach)) &&
            glm::all(glm::lessThanEqual(second.low, first.high + 2 * kReach))) {
            first.add(second.low), first.add(second.high);
            second = {};
        }
        for (const Box& box : scale.touched)
            if (!box.empty()) sum += spreadChange(scale, box);
    }
    return sum / (kScales * kKernelSum * kKernelSum * Goal::kWhite);
}

// Spreads the changes of a box over the surrounding nodes and returns by how much that changes the
// sum of |lack|. Resets the changes to 0.
double RunningScore::spreadChange(Scale& scale, const Box& box) {
    const glm::ivec2 from = glm::max(box.low - kReach, glm::ivec2(0)), to = glm::min(box.high + kReach, scale.nodes - 1);
    const int width = to.x - from.x + 1;
    const std::size_t start = scale.spread.size();
    scale.spread.resize(start + at(width) * at(to.y - from.y + 1), 0);
    row_.resize(at(width));
    for (int y = box.low.y; y <= box.high.y; ++y) {
        std::fill(row_.begin(), row_.end(), 0);
        double* changes = scale.change.data() + at(y) * at(scale.nodes.x);
        for (int x = box.low.x; x <= box.high.x; ++x) {
            const double pixels = std::exchange(changes[x], 0.0);
            if (pixels == 0) continue;
            const int first = std::max(x - kReach, from.x), last = std::min(x + kReach, to.x);
            for (int i = first; i <= last; ++i) row_[at(i - from.x)] += pixels * kernel_[at(i - x + kReach)];
        }
        const int first = std::max(y - kReach, from.y), last = std::min(y + kReach, to.y);
        for (int i = first; i <= last; ++i) {
            const double weight = kernel_[at(i - y + kReach)] * Goal::kWhite;
            double* out = scale.spread.data() + start + at(i - from.y) * at(width);
            for (int x = 0; x < width; ++x) out[x] -= weight * row_[at(x)];
        }
    }
    double sum = 0;
    for (int y = from.y; y <= to.y; ++y) {
        const double* lack = scale.lack.data() + at(y) * at(scale.nodes.x) + from.x;
        const double* change = scale.spread.data() + start + at(y - from.y) * at(width);
        for (int x = 0; x < width; ++x) sum += std::abs(lack[x] + change[x]) - std::abs(lack[x]);
    }
    return sum;
}

void RunningScore::accept(const PixelMask& out, const PixelMask& in) {
    // What covering these pixels of a word adds to sum |I - I'|.
    const auto costOf = [&](const Word& word, int column, int y, std::uint64_t pixels) {
        if (word.pulls < 0) return std::int64_t{word.cost} * std::popcount(pixels);
        std::int64_t cost = 0;
        while (pixels != 0) {
            const int begin = std::countr_zero(pixels), end = begin + std::countr_one(pixels >> begin);
            cost += space_.goal().cost(y, column * PixelMask::kBits + begin, column * PixelMask::kBits + end);
            if (end == PixelMask::kBits) break;
            pixels &= ~std::uint64_t{0} << end;
        }
        return cost;
    };
    const auto update = [&](const PixelMask& mask, auto change) {
        for (int column = mask.left(); column < mask.right(); ++column) {
            const PixelMask::Column outgoing = out.column(column), incoming = in.column(column);
            for (int y = mask.top(); y < mask.bottom(); ++y) {
                const std::uint64_t before = outgoing.at(y), after = incoming.at(y);
                if (before == after) continue;
                change(words_[wordAt(column, y)], wordAt(column, y), column, y, after & ~before, before & ~after);
            }
        }
    };
    update(out, [&](Word& word, std::size_t index, int column, int y, std::uint64_t, std::uint64_t goes) {
        if (goes == 0) return;
        const std::uint64_t freed = word.one & goes, several = goes & ~(word.one | word.two);
        if (freed != 0) sum_ -= costOf(word, column, y, freed);
        const std::uint64_t third = several != 0 ? counts_.three(index) & several : 0;
        counts_.remove(index, goes);
        word.none |= freed;
        word.one = (word.one & ~goes) | (word.two & goes);
        word.two = (word.two & ~goes) | third;
    });
    update(in, [&](Word& word, std::size_t index, int column, int y, std::uint64_t comes, std::uint64_t) {
        if (comes == 0) return;
        const std::uint64_t covered = word.none & comes;
        if (covered != 0) sum_ += costOf(word, column, y, covered);
        counts_.add(index, comes);
        word.two = (word.two & ~comes) | (word.one & comes);
        word.one = (word.one & ~comes) | covered;
        word.none &= ~comes;
    });
    coveredWhite_ += change_.coveredWhite, severalWhite_ += change_.severalWhite;
    for (const BlockChange& change : blockChanges_)
        lack_[at(change.block.y * blocks_.x + change.block.x)] -= std::int64_t{Goal::kWhite} * change.light;
    for (Scale& scale : scales_) {
        const double* change = scale.spread.data();
        for (const Box& box : scale.touched) {
            if (box.empty()) continue;
            const glm::ivec2 from = glm::max(box.low - kReach, glm::ivec2(0)), to = glm::min(box.high + kReach, scale.nodes - 1);
            for (int y = from.y; y <= to.y; ++y)
                for (int x = from.x; x <= to.x; ++x) scale.lack[at(y) * at(scale.nodes.x) + at(x)] += *change++;
        }
    }
}

double RunningScore::z() const { return static_cast<double>(sum_) / (static_cast<double>(Goal::kWhite) * width_ * height_); }

GreyImage RunningScore::picture() const {
    GreyImage picture(width_, height_);
    for (int y = 0; y < height_; ++y)
        for (int x = 0; x < width_; ++x)
            if ((words_[wordAt(x / PixelMask::kBits, y)].none >> (x % PixelMask::kBits) & 1) == 0) picture.at(x, y) = 1;
    return picture;
}

void RunningScore::findDarkPlaces() {
    darkness_.clear();
    const Scale& finest = scales_[0];
    std::int64_t sum = 0;
    std::size_t block = 0;
    for (int y = 0; y < blocks_.y; ++y)
        for (int x = 0; x < blocks_.x; ++x, ++block) {
            const bool counts = !region_ || region_->contains((glm::dvec2(x, y) + 0.5) * double(block_) / double(height_));
            if (counts && finest.lack[finest.at(finest.nodeOf({x, y}))] > 0)
                sum += std::max<std::int64_t>(0, lack_[block]) / kLightSteps;
            darkness_.push_back(sum);
        }
}

glm::ivec2 RunningScore::darkPlace(Rng& rng) const {
    const glm::ivec2 last = glm::ivec2(width_, height_) - 1;
    if (darkness_.back() == 0) {
        const glm::dvec2 from = region_ ? region_->from : glm::dvec2(0),
                         to = region_ ? region_->to : glm::dvec2(space_.aspect(), 1);
        return glm::clamp(glm::ivec2(glm::dvec2(rng.uniform(from.x, to.x), rng.uniform(from.y, to.y)) * double(height_)),
                          glm::ivec2(0), last);
    }
    const auto wanted = static_cast<std::int64_t>(rng.uniform() * static_cast<double>(darkness_.back()));
    const auto block = static_cast<int>(std::upper_bound(darkness_.begin(), darkness_.end(), wanted) - darkness_.begin());
    const glm::ivec2 corner = glm::ivec2(block % blocks_.x, block / blocks_.x) * block_;
    glm::ivec2 pixel(0);
    constexpr int kLooks = 8;
    for (int look = 0; look < kLooks; ++look) {
        pixel = glm::min(
            corner + glm::ivec2(rng.below(static_cast<std::uint32_t>(block_)), rng.below(static_cast<std::uint32_t>(block_))),
            last);
        if ((words_[wordAt(pixel.x / PixelMask::kBits, pixel.y)].none >> (pixel.x % PixelMask::kBits) & 1) != 0) break;
    }
    return pixel;
}

}  // namespace fantascope::pattern
