#include "theatre/mask/bit_mask.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace fantascope::theatre {
namespace {

// Sets the bits [first, last], both ends included.
void setBits(std::uint64_t* words, int first, int last) {
    constexpr unsigned kBits = BitMask::kBits;
    const unsigned from = static_cast<unsigned>(first), to = static_cast<unsigned>(last), firstWord = from / kBits,
                   lastWord = to / kBits;
    const std::uint64_t head = ~std::uint64_t{0} << (from % kBits), tail = ~std::uint64_t{0} >> (kBits - 1 - to % kBits);
    if (firstWord == lastWord) {
        words[firstWord] |= head & tail;
        return;
    }
    words[firstWord] |= head;
    for (unsigned i = firstWord + 1; i < lastWord; ++i) words[i] = ~std::uint64_t{0};
    words[lastWord] |= tail;
}

}  // namespace

void BitMask::clear() {
    if (rowsFrom_ < rowsTo_)
        std::fill(words_.begin() + static_cast<std::ptrdiff_t>(index(rowsFrom_)),
                  words_.begin() + static_cast<std::ptrdiff_t>(index(rowsTo_)), 0);
    rowsFrom_ = 1 << 30, rowsTo_ = 0;
}

void BitMask::fill(int y, int from, int to) {
    from = std::max(from, 0), to = std::min(to, width_);
    if (from >= to) return;
    setBits(words_.data() + index(y), from, to - 1);
    spread(y, y + 1);
}

void BitMask::fill(int y, std::span<const float> from, std::span<const float> to) {
    const auto width = static_cast<float>(width_);
    std::uint64_t* words = words_.data() + index(y);
    for (std::size_t row = 0; row < from.size(); ++row, words += stride_) {
        const int first = static_cast<int>(std::max(0.0f, std::min(from[row], width)) + 0.5f);
        const int end = static_cast<int>(std::max(0.0f, std::min(to[row], width)) + 0.5f);
        if (first < end) setBits(words, first, end - 1);
    }
    spread(y, y + static_cast<int>(from.size()));
}

void BitMask::add(const BitMask& other) {
    if (other.rowsFrom_ >= other.rowsTo_) return;
    const std::size_t from = index(other.rowsFrom_), to = index(other.rowsTo_);
    for (std::size_t i = from; i < to; ++i) words_[i] |= other.words_[i];
    spread(other.rowsFrom_, other.rowsTo_);
}

void BitMask::keep(int left, int top, int right, int bottom) {
    left = std::max(left, 0), right = std::min(right, width_);
    std::vector<std::uint64_t> kept(static_cast<std::size_t>(stride_), 0);
    if (left < right) setBits(kept.data(), left, right - 1);
    for (int y = std::max(0, rowsFrom_); y < rowsTo_; ++y) {
        const bool isIn = y >= top && y < bottom;
        for (std::size_t i = 0; i < kept.size(); ++i) words_[index(y) + i] &= isIn ? kept[i] : 0;
    }
}

void BitMask::keep(const BitMask& other) {
    for (std::size_t i = 0; i < words_.size(); ++i) words_[i] &= other.words_[i];
}

std::int64_t BitMask::count() const {
    std::int64_t count = 0;
    for (const std::uint64_t word : words_) count += std::popcount(word);
    return count;
}

std::int64_t differing(const BitMask& a, const BitMask& b) {
    std::int64_t count = 0;
    for (std::size_t i = 0; i < a.words_.size(); ++i) count += std::popcount(a.words_[i] ^ b.words_[i]);
    return count;
}

std::int64_t shared(const BitMask& a, const BitMask& b) {
    std::int64_t count = 0;
    for (std::size_t i = 0; i < a.words_.size(); ++i) count += std::popcount(a.words_[i] & b.words_[i]);
    return count;
}

double intersectionOverUnion(const BitMask& a, const BitMask& b) {
    const std::int64_t both = shared(a, b);
    return static_cast<double>(both) / static_cast<double>(both + differing(a, b));
}

BitMask difference(const BitMask& a, const BitMask& b) {
    BitMask result(a.width(), a.height());
    for (int y = 0; y < a.height(); ++y) {
        for (std::size_t i = 0; i < a.row(y).size(); ++i) result.row(y)[i] = a.row(y)[i] ^ b.row(y)[i];
        result.noteRow(y);
    }
    return result;
}

bool meet(const BitMask& a, const BitMask& b) {
    for (int y = std::max({0, a.rowsFrom(), b.rowsFrom()}); y < std::min(a.rowsTo(), b.rowsTo()); ++y)
        for (std::size_t i = 0; i < a.row(y).size(); ++i)
            if ((a.row(y)[i] & b.row(y)[i]) != 0) return true;
    return false;
}

bool isWithin(const BitMask& inner, const BitMask& outer) {
    for (int y = std::max(0, inner.rowsFrom()); y < inner.rowsTo(); ++y)
        for (std::size_t i = 0; i < inner.row(y).size(); ++i)
            if ((inner.row(y)[i] & ~outer.row(y)[i]) != 0) return false;
    return true;
}

bool operator==(const BitMask& a, const BitMask& b) {
    return a.width_ == b.width_ && a.height_ == b.height_ && a.words_ == b.words_;
}

void Changes::find(const BitMask& a, const BitMask& b) {
    stride_ = static_cast<std::size_t>(a.stride()), bands_ = (a.height() + kBand - 1) / kBand;
    columns_.assign(stride_ * static_cast<std::size_t>(bands_), 0);
    std::uint64_t any = 0;
    for (int y = std::max(0, std::min(a.rowsFrom(), b.rowsFrom())); y < std::max(a.rowsTo(), b.rowsTo()); ++y) {
        const auto one = a.row(y), other = b.row(y);
        std::uint64_t* const columns = &columns_[stride_ * static_cast<std::size_t>(y / kBand)];
        for (std::size_t i = 0; i < stride_; ++i) {
            const std::uint64_t differing = one[i] ^ other[i];
            columns[i] |= differing;
            any |= differing;
        }
    }
    isAny_ = any != 0;
}

bool Changes::mayReach(glm::ivec2 pixel, int within) const {
    const int width = 2 * within + 1;
    if (width > BitMask::kBits) return isAny_;
    const int last = std::min((pixel.y + within) / kBand, bands_ - 1);
    for (int band = std::max(0, pixel.y - within) / kBand; band <= last; ++band) {
        const auto columns = std::span(columns_).subspan(stride_ * static_cast<std::size_t>(band), stride_);
        if (window(columns, pixel.x - within, width) != 0) return true;
    }
    return false;
}

void ConvexFiller::fill(std::span<const glm::vec2> polygon, BitMask& mask) {
    float top = std::numeric_limits<float>::max(), bottom = -top;
    for (const glm::vec2& point : polygon) top = std::min(top, point.y), bottom = std::max(bottom, point.y);
    // The first row whose centre is not above y, and the last row whose centre is not below y,
    // clamped to the mask.
    const auto height = static_cast<float>(mask.height());
    const auto rowFrom = [&](float y) { return static_cast<int>(std::ceil(std::clamp(y, 0.0f, height) - 0.5f)); };
    const auto rowTo = [&](float y) { return static_cast<int>(std::floor(std::clamp(y, 0.0f, height) - 0.5f)); };
    const int first = rowFrom(top), last = rowTo(bottom);
    if (first > last) return;
    const auto rows = static_cast<std::size_t>(last - first + 1);
    left_.assign(rows, 0);
    right_.assign(rows, 0);
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        glm::vec2 a = polygon[i], b = polygon[i + 1 == polygon.size() ? 0 : i + 1];
        // An edge that goes down bounds the polygon on the right; one that goes up, on the left.
        std::vector<float>& side = b.y > a.y ? right_ : left_;
        if (a.y > b.y) std::swap(a, b);
        const int from = rowFrom(a.y), to = rowTo(b.y);
        // A horizontal edge has no slope. Its neighbours provide its ends.
        if (from > to || a.y == b.y) continue;
        const float slope = (b.x - a.x) / (b.y - a.y);
        float x = a.x + (static_cast<float>(from) + 0.5f - a.y) * slope;
        for (auto row = static_cast<std::size_t>(from - first); row <= static_cast<std::size_t>(to - first); ++row, x += slope)
            side[row] = x;
    }
    mask.fill(first, left_, right_);
}

void ConvexFiller::fill(std::array<glm::vec2, 3> triangle, BitMask& mask) {
    const glm::vec2 one = triangle[1] - triangle[0], other = triangle[2] - triangle[0];
    if (one.x * other.y - one.y * other.x < 0) std::swap(triangle[1], triangle[2]);
    fill(std::span<const glm::vec2>(triangle), mask);
}

BitMask filled(int width, int height, std::span<const glm::uvec3> triangles, std::span<const glm::dvec2> corners) {
    BitMask mask(width, height);
    ConvexFiller filler;
    for (const glm::uvec3& triangle : triangles)
        filler.fill({glm::vec2(corners[triangle.x]), glm::vec2(corners[triangle.y]), glm::vec2(corners[triangle.z])}, mask);
    return mask;
}

}  // namespace fantascope::theatre
