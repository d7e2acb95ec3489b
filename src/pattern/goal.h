#pragma once

#include "pattern/coverage.h"

#include "core/image.h"

#include <cstdint>
#include <vector>

namespace fantascope::pattern {

// The guide as the search compares it: the goal function z and the difference indices g_i of Ji et al. 2015, section 4.1. The
// guide's values are held as whole numbers, so every sum is exact and does not depend on its order. Thread: every const method is
// reentrant.
class Goal {
public:
    // `guide`: stored values 0..1, in the pattern's resolution.
    explicit Goal(const GreyImage& guide);

    int width() const { return width_; }
    int height() const { return height_; }
    double mean() const;   // of the guide
    double bound() const;  // the least z that any pattern of white shapes on black could have: mean min(I, 1 - I)

    // z(I') = mean |I - I'|, in [0, 1].
    double z(const Coverage& pattern) const;
    // g_i: the mean of the difference image R = I - I' over one evaluation cell, in [-1, 1]; positive where more coverage is
    // wanted. The cell lies in the picture and has pixels.
    double differenceIndex(const PixelRectangle& cell, const Coverage& pattern) const;

private:
    std::int64_t guideSum(const PixelRectangle& cell) const;

    int width_, height_;
    std::vector<std::int64_t> sums_;        // summed-area table of the guide, a row and a column of zeros first
    std::vector<std::int32_t> whiteCosts_;  // by row: running sums of what covering a pixel adds to z, a zero first
};

}  // namespace fantascope::pattern
