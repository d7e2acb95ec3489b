#pragma once

#include "media/image.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace fantascope::theatre {

// A picture of one bit a pixel. A word holds 64 neighbouring pixels of a row, the leftmost in the
// lowest bit. Bits beyond the width are 0. `rowsFrom` and `rowsTo` bound the rows that have a white
// pixel.
class BitMask {
public:
    static constexpr int kBits = 64;

    BitMask() = default;
    BitMask(int width, int height)
        : width_(width),
          height_(height),
          stride_((width + kBits - 1) / kBits),
          words_(static_cast<std::size_t>(stride_ * height), 0) {}

    int width() const { return width_; }
    int height() const { return height_; }
    int stride() const { return stride_; }  // words a row
    int rowsFrom() const { return rowsFrom_; }
    int rowsTo() const { return rowsTo_; }  // one beyond the last
    std::span<std::uint64_t> row(int y) { return std::span(words_).subspan(index(y), static_cast<std::size_t>(stride_)); }
    std::span<const std::uint64_t> row(int y) const {
        return std::span(words_).subspan(index(y), static_cast<std::size_t>(stride_));
    }
    bool at(int x, int y) const {
        return x >= 0 && y >= 0 && x < width_ && y < height_ &&
               (words_[index(y) + static_cast<std::size_t>(x / kBits)] >> (x % kBits) & 1) != 0;
    }

    void clear();
    // Sets the pixels [from, to) of a row to white. The range is clipped to the width.
    void fill(int y, int from, int to);
    // The same for consecutive rows from y on, with fractional bounds: a pixel becomes white if its
    // centre lies between them.
    void fill(int y, std::span<const float> from, std::span<const float> to);
    void add(const BitMask& other);
    // Blackens all pixels outside columns [left, right) and rows [top, bottom).
    void keep(int left, int top, int right, int bottom);
    void keep(const BitMask& other);           // blackens what is black in `other`, which has the same size
    void noteRow(int y) { spread(y, y + 1); }  // must be called after words of this row were set through row()
    std::int64_t count() const;
    friend std::int64_t differing(const BitMask& a, const BitMask& b);
    friend std::int64_t shared(const BitMask& a, const BitMask& b);
    friend bool operator==(const BitMask& a, const BitMask& b);

private:
    std::size_t index(int y) const { return static_cast<std::size_t>(y) * static_cast<std::size_t>(stride_); }
    void spread(int from, int to) { rowsFrom_ = std::min(rowsFrom_, from), rowsTo_ = std::max(rowsTo_, to); }

    int width_ = 0, height_ = 0, stride_ = 0;
    int rowsFrom_ = 1 << 30, rowsTo_ = 0;
    std::vector<std::uint64_t> words_;
};

// Comparisons of two masks of one size. differing(): the number of pixels that differ. shared():
// the number that are white in both. meet(): whether any pixel is white in both. isWithin():
// whether every white pixel of `inner` is white in `outer`.
std::int64_t differing(const BitMask& a, const BitMask& b);
std::int64_t shared(const BitMask& a, const BitMask& b);
BitMask difference(const BitMask& a, const BitMask& b);
double intersectionOverUnion(const BitMask& a, const BitMask& b);  // at least one mask has a white pixel
bool meet(const BitMask& a, const BitMask& b);
bool isWithin(const BitMask& inner, const BitMask& outer);

// `count` bits (1 .. 64) of a mask's row, from column x on. Columns outside the mask read as 0.
inline std::uint64_t window(std::span<const std::uint64_t> row, int x, int count) {
    const std::uint64_t mask = ~std::uint64_t{0} >> (BitMask::kBits - count);
    if (x < 0) return x + count <= 0 ? 0 : (row[0] << -x) & mask;
    const auto word = static_cast<std::size_t>(x / BitMask::kBits);
    const int shift = x % BitMask::kBits;
    if (word >= row.size()) return 0;
    std::uint64_t bits = row[word] >> shift;
    if (shift != 0 && word + 1 < row.size()) bits |= row[word + 1] << (BitMask::kBits - shift);
    return bits & mask;
}

// Where two masks of one size differ. For each band of kBand rows it keeps the columns that differ.
class Changes {
public:
    void find(const BitMask& a, const BitMask& b);
    bool isAny() const { return isAny_; }
    // Whether a differing pixel may lie within this distance in x and in y. True is conservative;
    // false is exact.
    bool mayReach(glm::ivec2 pixel, int within) const;

private:
    static constexpr int kBand = 8;  // rows
    std::size_t stride_ = 0;         // words a band
    int bands_ = 0;
    bool isAny_ = false;
    std::vector<std::uint64_t> columns_;
};

// Fills convex polygons. Points are in pixels, clockwise as seen.
class ConvexFiller {
public:
    void fill(std::span<const glm::vec2> polygon, BitMask& mask);
    // A triangle, in either orientation.
    void fill(std::array<glm::vec2, 3> triangle, BitMask& mask);

private:
    std::vector<float> left_, right_;  // scratch, kept for its memory
};

// The union of triangles as a mask. `corners` are in pixels, x right, y down.
BitMask filled(int width, int height, std::span<const glm::uvec3> triangles, std::span<const glm::dvec2> corners);

}  // namespace fantascope::theatre
