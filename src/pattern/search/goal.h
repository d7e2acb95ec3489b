#pragma once

#include "pattern/search/coverage.h"

#include "media/image.h"

#include <cstdint>
#include <vector>

namespace fantascope::pattern {

// The guide as the search compares it: the goal function z and the difference indices g_i of Ji et
// al. 2015, section 4.1. The guide's values are held as whole numbers, so every sum is exact and
// does not depend on its order. Thread: every const method is reentrant.
class Goal {
public:
    // `guide`: stored values 0..1, in the pattern's resolution.
    explicit Goal(const GreyImage& guide);

    // A 16-bit PNG's values are exact in these units, and an 8-bit one's too: 65535 = 257 * 255.
    static constexpr int kWhite = 65535;

    int width() const { return width_; }
    int height() const { return height_; }
    double mean() const;   // of the guide
    double bound() const;  // the least z that any pattern of white shapes on black could have: mean min(I, 1 - I)

    // In units of 1 / kWhite: what covering the pixels begin <= x < end of row y adds to sum |I -
    // I'|; the guide's sum over a rectangle; and sum |I - I'| for a pattern without instances.
    std::int64_t cost(int y, int begin, int end) const { return whiteCosts_[index(end, y)] - whiteCosts_[index(begin, y)]; }
    std::int64_t guideSum(const PixelRectangle& cell) const;
    std::int64_t allBlack() const { return guideSum({{0, 0}, {width_, height_}}); }
    double value(int x, int y) const { return 0.5 * double(kWhite - cost(y, x, x + 1)) / kWhite; }  // of the guide, 0..1

    // z(I') = mean |I - I'|, in [0, 1].
    double z(const Coverage& pattern) const;
    // g_i: the mean of the difference image R = I - I' over one evaluation cell, in [-1, 1];
    // positive where more coverage is wanted. The cell lies in the picture and has pixels.
    double differenceIndex(const PixelRectangle& cell, const Coverage& pattern) const;

private:
    std::size_t index(int x, int y) const {  // into whiteCosts_
        return static_cast<std::size_t>(y) * (static_cast<std::size_t>(width_) + 1) + static_cast<std::size_t>(x);
    }
    int width_, height_;
    std::vector<std::int64_t> sums_;        // summed-area table of the guide, a row and a column of zeros first
    std::vector<std::int32_t> whiteCosts_;  // by row: running sums of what covering a pixel adds to z, a zero first
};

}  // namespace fantascope::pattern
