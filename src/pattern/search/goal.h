#pragma once

#include "pattern/search/coverage.h"

#include "media/image.h"

#include <cstdint>
#include <vector>

namespace fantascope::pattern {

// The goal of a search: the goal function z and the difference indices g_i of Ji et al. 2015,
// section 4.1, for one guide. The guide's values are stored as integers, so every sum is exact and
// independent of its order. On a surface that is not evenly white, I' is what is seen there: white
// times the surface's light. Thread: every const method is reentrant.
class Goal {
public:
    // `guide`: compared values 0..1 (comparedGuide), in the pattern's resolution. `surface`: the
    // light that a white shape gives, 0 .. kMostLight, in the same resolution; null: 1 everywhere.
    explicit Goal(const GreyImage& guide, const GreyImage* surface = nullptr);
    static constexpr float kMostLight = 4;

    // White in integer units. The values of 16-bit and 8-bit PNGs are exact in them, as 65535 = 257
    // * 255.
    static constexpr int kWhite = 65535;

    int width() const { return width_; }
    int height() const { return height_; }
    double mean() const;   // of the guide
    double bound() const;  // lower bound of z for any pattern of white shapes on black: mean min(I, 1 - I)
    // The share of the picture to cover, so that each place has the guide's light as far as it can.
    double wantedCoverage() const;
    // What a white shape gives at a pixel; whether that is 1 everywhere.
    double light(int x, int y) const { return isEven() ? 1 : double(surface_.at(x, y)); }
    bool isEven() const { return surface_.empty(); }

    // In units of 1 / kWhite: by how much covering the pixels begin <= x < end of row y changes sum
    // |I - I'|; the guide's sum over a rectangle; and sum |I - I'| of a pattern without instances.
    std::int64_t cost(int y, int begin, int end) const { return whiteCosts_[index(end, y)] - whiteCosts_[index(begin, y)]; }
    std::int64_t guideSum(const PixelRectangle& cell) const;
    std::int64_t allBlack() const { return guideSum({{0, 0}, {width_, height_}}); }
    double value(int x, int y) const { return double(guideSum({{x, y}, {x + 1, y + 1}})) / kWhite; }  // of the guide, 0..1

    // z(I') = mean |I - I'|, in [0, 1].
    double z(const Coverage& pattern) const;
    // g_i: the mean of the difference image R = I - I' over one evaluation cell, in [-1, 1];
    // positive where more coverage is needed. The cell lies in the picture and is not empty. The
    // surface is even.
    double differenceIndex(const PixelRectangle& cell, const Coverage& pattern) const;

private:
    std::size_t index(int x, int y) const {  // into whiteCosts_
        return static_cast<std::size_t>(y) * (static_cast<std::size_t>(width_) + 1) + static_cast<std::size_t>(x);
    }
    int width_, height_;
    GreyImage surface_;                     // empty: even
    std::vector<std::int64_t> sums_;        // summed-area table of the guide; its first row and column are 0
    std::vector<std::int32_t> whiteCosts_;  // per row: running sums of cost(), beginning with 0
};

}  // namespace fantascope::pattern
