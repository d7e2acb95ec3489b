#include "pattern/search/coverage.h"

#include "core/check.h"

#include <algorithm>

namespace fantascope::pattern {

Coverage::Coverage(int width, int height)
    : width_(width), height_(height), stride_(static_cast<std::size_t>((width + kBits - 1) / kBits)), scanner_(width, height) {
    FANTASCOPE_CHECK(width > 0 && height > 0, "a picture has pixels");
    words_.assign(stride_ * static_cast<std::size_t>(height), 0);
}

void Coverage::clear() { std::fill(words_.begin(), words_.end(), 0); }

void Coverage::add(const Silhouette& shape, const InstancePose& pose) {
    scanner_.scan(shape, pose, [&](int y, int begin, int end) { addSpan(y, begin, end); });
}

void Coverage::addSpan(int y, int begin, int end) {
    std::uint64_t* row = words_.data() + static_cast<std::size_t>(y) * stride_;
    const unsigned b = begin, e = end - 1;
    const unsigned first = b / kBits, last = e / kBits;
    const std::uint64_t from = ~std::uint64_t{0} << (b % kBits), upTo = ~std::uint64_t{0} >> (kBits - 1 - e % kBits);
    if (first == last) {
        row[first] |= from & upTo;
        return;
    }
    row[first] |= from;
    std::fill(row + first + 1, row + last, ~std::uint64_t{0});
    row[last] |= upTo;
}

std::int64_t Coverage::count(const PixelRectangle& cell) const {
    std::int64_t covered = 0;
    if (cell.begin.x == cell.end.x) return covered;
    const int first = cell.begin.x / kBits, last = (cell.end.x - 1) / kBits;
    const std::uint64_t from = ~std::uint64_t{0} << (cell.begin.x % kBits);
    const std::uint64_t upTo = ~std::uint64_t{0} >> (kBits - 1 - (cell.end.x - 1) % kBits);
    for (int y = cell.begin.y; y < cell.end.y; ++y) {
        const std::uint64_t* row = words_.data() + static_cast<std::size_t>(y) * stride_;
        for (int i = first; i <= last; ++i) {
            std::uint64_t bits = row[i];
            if (i == first) bits &= from;
            if (i == last) bits &= upTo;
            covered += std::popcount(bits);
        }
    }
    return covered;
}

GreyImage Coverage::picture() const {
    GreyImage picture(width_, height_);
    forEachRun([&](int y, int begin, int end) {
        for (int x = begin; x < end; ++x) picture.at(x, y) = 1;
    });
    return picture;
}

}  // namespace fantascope::pattern
