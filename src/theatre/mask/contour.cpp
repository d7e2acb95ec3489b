#include "theatre/mask/contour.h"

#include "core/check.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

namespace fantascope::theatre {
namespace {

// For the bits of half a disc row: how many are set, and the sum of their positions.
constexpr int kHalf = 16;
struct Bits {
    std::uint8_t count = 0, places = 0;
};
std::vector<Bits> bitsTable() {
    std::vector<Bits> table(1u << kHalf);
    for (unsigned bits = 1; bits < table.size(); ++bits) {
        const int lowest = std::countr_zero(bits);
        const Bits rest = table[bits & (bits - 1)];
        table[bits] = {static_cast<std::uint8_t>(rest.count + 1), static_cast<std::uint8_t>(rest.places + lowest)};
    }
    return table;
}

}  // namespace

ContourDisc::ContourDisc(double radius) : radius_(static_cast<int>(radius)) {
    FANTASCOPE_CHECK(radius >= 1 && radius_ < kHalf, "a disc's row fits into two halves of a table");
    for (int y = -radius_; y <= radius_; ++y) {
        const int half = static_cast<int>(std::sqrt(radius * radius - y * y));
        rows_.push_back(((std::uint64_t{1} << (2 * half + 1)) - 1) << (radius_ - half));
        full_ += 2 * half + 1;
    }
}

ContourPoint ContourDisc::at(const BitMask& mask, glm::ivec2 pixel) const {
    static const std::vector<Bits> table = bitsTable();
    int area = 0;
    glm::ivec2 moment(0);
    const int from = std::max(-radius_, -pixel.y), to = std::min(radius_, mask.height() - 1 - pixel.y), width = 2 * radius_ + 1;
    for (int dy = from; dy <= to; ++dy) {
        const std::uint64_t bits =
            window(mask.row(pixel.y + dy), pixel.x - radius_, width) & rows_[static_cast<std::size_t>(dy + radius_)];
        const Bits low = table[bits & (table.size() - 1)];
        int count = low.count, places = low.places;
        if (width > kHalf) {
            const Bits high = table[bits >> kHalf];
            count += high.count, places += high.places + kHalf * high.count;
        }
        area += count;
        moment += glm::ivec2(places - radius_ * count, dy * count);
    }
    ContourPoint point{pixel};
    const double length = glm::length(glm::dvec2(moment));
    if (length > 0) point.normal = -glm::dvec2(moment) / length;
    // The pixel itself is white and lies on the contour, so half of the disc's middle row is
    // subtracted.
    const double share = (area - radius_ - 0.5) / full_;
    point.curvature = 3 * std::numbers::pi * (0.5 - share);
    return point;
}

void Contour::find(const BitMask& mask) {
    if (pixels_.width() != mask.width() || pixels_.height() != mask.height()) pixels_ = BitMask(mask.width(), mask.height());
    pixels_.clear();
    const auto stride = static_cast<std::size_t>(mask.stride());
    for (int y = std::max(0, mask.rowsFrom()); y < mask.rowsTo(); ++y) {
        const std::uint64_t* row = mask.row(y).data();
        const std::uint64_t* above = y > 0 ? row - stride : nullptr;
        const std::uint64_t* below = y + 1 < mask.height() ? row + stride : nullptr;
        std::uint64_t* out = pixels_.row(y).data();
        std::uint64_t any = 0;
        for (std::size_t i = 0; i < stride; ++i) {
            const std::uint64_t left = row[i] << 1 | (i > 0 ? row[i - 1] >> 63 : 0);
            const std::uint64_t right = row[i] >> 1 | (i + 1 < stride ? row[i + 1] << 63 : 0);
            const std::uint64_t inside = left & right & (above != nullptr ? above[i] : 0) & (below != nullptr ? below[i] : 0);
            any |= out[i] = row[i] & ~inside;
        }
        if (any != 0) pixels_.noteRow(y);
    }
}

std::optional<glm::ivec2> Contour::nearest(glm::ivec2 pixel, std::optional<glm::ivec2> other) const {
    std::optional<glm::ivec2> best = other;
    int least = std::numeric_limits<int>::max();
    if (other) {
        const glm::ivec2 away = *other - pixel;
        least = away.x * away.x + away.y * away.y + 1;  // a tie is still found in scan order
    }
    const auto take = [&](int x, int y) {
        const glm::ivec2 away = glm::ivec2(x, y) - pixel;
        const int distance = away.x * away.x + away.y * away.y;
        if (distance < least) least = distance, best = glm::ivec2(x, y);
    };
    // One word around the pixel's column covers every column less than half a word away: first its
    // own column and those on the left, then those on the right.
    constexpr int kHalf = BitMask::kBits / 2;
    const auto lookNear = [&](int y) {
        const std::uint64_t bits = window(pixels_.row(y), pixel.x - kHalf, BitMask::kBits);
        const std::uint64_t left = bits << (kHalf - 1), right = bits >> (kHalf + 1);
        if (left != 0) take(pixel.x - std::countl_zero(left), y);
        if (right != 0) take(pixel.x + 1 + std::countr_zero(right), y);
    };
    // The first set bit on the left and on the right, word by word.
    const auto lookFar = [&](int y) {
        const auto row = pixels_.row(y);
        const int last = pixels_.stride() - 1, own = std::clamp(pixel.x / BitMask::kBits, 0, last);
        const std::uint64_t upTo = ~std::uint64_t{0} >> (BitMask::kBits - 1 - std::clamp(pixel.x - own * BitMask::kBits, 0, 63));
        std::uint64_t bits = row[static_cast<std::size_t>(own)] & upTo;
        for (int i = own; bits != 0 || i > 0; bits = row[static_cast<std::size_t>(--i)])
            if (bits != 0) {
                take(i * BitMask::kBits + 63 - std::countl_zero(bits), y);
                break;
            }
        bits = row[static_cast<std::size_t>(own)] & ~upTo;
        for (int i = own; bits != 0 || i < last; bits = row[static_cast<std::size_t>(++i)])
            if (bits != 0) {
                take(i * BitMask::kBits + std::countr_zero(bits), y);
                break;
            }
    };
    const auto look = [&](int y) {
        if (least > kHalf * kHalf)
            lookFar(y);
        else
            lookNear(y);
    };
    const int from = std::max(0, pixels_.rowsFrom()), to = pixels_.rowsTo() - 1;
    for (int away = 0;; ++away) {
        if (std::int64_t{away} * away >= least || (pixel.y - away < from && pixel.y + away > to)) return best;
        if (pixel.y - away >= from && pixel.y - away <= to) look(pixel.y - away);
        if (away > 0 && pixel.y + away >= from && pixel.y + away <= to) look(pixel.y + away);
    }
}

std::vector<glm::ivec2> outerContour(const BitMask& mask) {
    // The eight neighbours, clockwise as seen (y down), from the left one.
    constexpr std::array<glm::ivec2, 8> kAround = {
        glm::ivec2{-1, 0}, {-1, -1}, {0, -1}, {1, -1}, {1, 0}, {1, 1}, {0, 1}, {-1, 1}};
    const auto at = [&](glm::ivec2 p) { return mask.at(p.x, p.y); };
    BitMask seen(mask.width(), mask.height());
    std::vector<glm::ivec2> largest;
    double largestArea = 0;
    for (int y = std::max(0, mask.rowsFrom()); y < mask.rowsTo(); ++y)
        for (int x = 0; x < mask.width(); ++x) {
            // Each outer contour is traced once, from its topmost leftmost pixel. A start on an
            // inner contour is told apart by its area below.
            if (!mask.at(x, y) || mask.at(x - 1, y) || seen.at(x, y)) continue;
            std::vector<glm::ivec2> chain;
            glm::ivec2 here(x, y);
            std::size_t back = 0;  // the direction of the black neighbour examined last
            const std::size_t limit = 4 * static_cast<std::size_t>(mask.width()) * static_cast<std::size_t>(mask.height());
            std::optional<std::size_t> firstMove;
            while (chain.size() < limit) {
                std::optional<std::size_t> move;
                for (std::size_t i = 1; i <= 8 && !move; ++i)
                    if (at(here + kAround[(back + i) % 8])) move = (back + i) % 8;
                if (here == glm::ivec2(x, y) && !chain.empty() && move == firstMove) break;
                chain.push_back(here);
                seen.fill(here.y, here.x, here.x + 1);
                if (!move) break;  // a single pixel
                if (!firstMove) firstMove = move;
                here += kAround[*move];
                // The neighbour examined last, as seen from the new pixel.
                back = (*move + (*move % 2 == 0 ? 6 : 5)) % 8;
            }
            double area = 0;
            for (std::size_t i = 0; i < chain.size(); ++i) {
                const glm::dvec2 a = chain[i], b = chain[(i + 1) % chain.size()];
                area += 0.5 * (a.x * b.y - a.y * b.x);
            }
            // An outer contour runs clockwise as seen, so with y down its area is positive.
            if (area > largestArea || largest.empty()) largestArea = area, largest = std::move(chain);
        }
    return largest;
}

std::vector<glm::ivec2> sampled(const std::vector<glm::ivec2>& contour, std::size_t count) {
    std::vector<double> lengths(1, 0);
    for (std::size_t i = 0; i < contour.size(); ++i)
        lengths.push_back(lengths.back() + glm::distance(glm::dvec2(contour[i]), glm::dvec2(contour[(i + 1) % contour.size()])));
    std::vector<glm::ivec2> samples;
    std::size_t next = 0;
    for (std::size_t i = 0; i < count && !contour.empty(); ++i) {
        const double wanted = lengths.back() * static_cast<double>(i) / static_cast<double>(count);
        while (next + 1 < contour.size() && lengths[next + 1] <= wanted) ++next;
        samples.push_back(contour[next]);
    }
    return samples;
}

}  // namespace fantascope::theatre
