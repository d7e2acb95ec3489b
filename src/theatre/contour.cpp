#include "theatre/contour.h"

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

// `count` bits of a row from column x on, x may lie outside.
std::uint64_t window(std::span<const std::uint64_t> row, int x, int count) {
    const std::uint64_t mask = (std::uint64_t{1} << count) - 1;
    if (x < 0) return x + count <= 0 ? 0 : (row[0] << -x) & mask;
    const auto word = static_cast<std::size_t>(x / BitMask::kBits);
    const int shift = x % BitMask::kBits;
    if (word >= row.size()) return 0;
    std::uint64_t bits = row[word] >> shift;
    if (shift != 0 && word + 1 < row.size()) bits |= row[word + 1] << (BitMask::kBits - shift);
    return bits & mask;
}

// Of the numbers 0..31, those with bit k, as a mask.
constexpr std::array<std::uint64_t, 5> kPlanes = {0xaaaaaaaa, 0xcccccccc, 0xf0f0f0f0, 0xff00ff00, 0xffff0000};

}  // namespace

ContourDisc::ContourDisc(double radius) : radius_(static_cast<int>(radius)), exactRadius_(radius) {
    FANTASCOPE_CHECK(radius >= 1 && radius_ <= 15, "a disc fits into half a word");
    for (int y = -radius_; y <= radius_; ++y) halves_.push_back(static_cast<int>(std::sqrt(radius * radius - y * y)));
}

ContourPoint ContourDisc::at(const BitMask& mask, glm::ivec2 pixel) const {
    int area = 0, full = 0;
    glm::ivec2 moment(0);
    for (int dy = -radius_; dy <= radius_; ++dy) {
        const int half = halves_[static_cast<std::size_t>(dy + radius_)], y = pixel.y + dy;
        full += 2 * half + 1;
        if (y < 0 || y >= mask.height()) continue;
        const std::uint64_t bits = window(mask.row(y), pixel.x - half, 2 * half + 1);
        const int count = std::popcount(bits);
        int x = -half * count;
        for (std::size_t k = 0; k < kPlanes.size(); ++k) x += std::popcount(bits & kPlanes[k]) << k;
        area += count;
        moment += glm::ivec2(x, dy * count);
    }
    ContourPoint point{pixel};
    const double length = std::hypot(moment.x, moment.y);
    if (length > 0) point.normal = -glm::dvec2(moment) / length;
    // The pixel itself is white and lies on the line: half of what the disc's middle row takes.
    const double share = (area - radius_ - 0.5) / full;
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
        least = away.x * away.x + away.y * away.y + 1;  // one that is as near is still found in its turn
    }
    const auto look = [&](int y) {
        const auto row = pixels_.row(y);
        const int dy = y - pixel.y, square = dy * dy;
        const int word = std::clamp(pixel.x / BitMask::kBits, 0, pixels_.stride() - 1), bit = pixel.x - word * BitMask::kBits;
        const auto take = [&](int x) {
            const int dx = x - pixel.x, distance = dx * dx + square;
            if (distance < least) least = distance, best = glm::ivec2(x, y);
        };
        const auto reaches = [&](int dx) { return dx < 0 || dx * dx + square < least; };
        // To the left, the pixel's own column included, then to the right.
        std::uint64_t bits =
            bit < 0 ? 0 : row[static_cast<std::size_t>(word)] & (bit >= 63 ? ~std::uint64_t{0} : (std::uint64_t{2} << bit) - 1);
        for (int i = word;; bits = row[static_cast<std::size_t>(i)]) {
            if (bits != 0) {
                take(i * BitMask::kBits + 63 - std::countl_zero(bits));
                break;
            }
            if (--i < 0 || !reaches(pixel.x - (i * BitMask::kBits + 63))) break;
        }
        bits = bit < 0     ? row[static_cast<std::size_t>(word)]
               : bit >= 63 ? 0
                           : row[static_cast<std::size_t>(word)] & ~((std::uint64_t{2} << bit) - 1);
        for (int i = word;; bits = row[static_cast<std::size_t>(i)]) {
            if (bits != 0) {
                take(i * BitMask::kBits + std::countr_zero(bits));
                break;
            }
            if (++i >= pixels_.stride() || !reaches(i * BitMask::kBits - pixel.x)) break;
        }
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
            // Each island once, from its topmost leftmost pixel; an inner contour's pixels have white on their left or were seen.
            if (!mask.at(x, y) || mask.at(x - 1, y) || seen.at(x, y)) continue;
            std::vector<glm::ivec2> chain;
            glm::ivec2 here(x, y);
            std::size_t back = 0;  // the neighbour from which we came: black
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
                // The neighbour looked at before, as seen from the new place.
                back = (*move + (*move % 2 == 0 ? 6 : 5)) % 8;
            }
            double area = 0;
            for (std::size_t i = 0; i < chain.size(); ++i) {
                const glm::dvec2 a = chain[i], b = chain[(i + 1) % chain.size()];
                area += 0.5 * (a.x * b.y - a.y * b.x);
            }
            // Clockwise as seen, with y down, has a positive area: an outer contour.
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
