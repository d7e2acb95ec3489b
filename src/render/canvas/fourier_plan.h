#pragma once

#include "media/image.h"

#include <glm/vec2.hpp>

#include <array>
#include <complex>
#include <vector>

namespace fantascope::render {

// How a Fourier transform of a whole number of points splits into passes of small radices, and
// where it leaves its frequencies: assets/shaders/convolve.comp takes one pass after the other in
// place and never brings them into order.
class FourierPlan {
public:
    // The cheapest transform of at least `points` points: the fewest points times passes. points >
    // 0.
    explicit FourierPlan(int points);

    int length() const { return length_; }                        // the product of the radices
    const std::vector<int>& radices() const { return radices_; }  // of the passes forward, each of kRadices
    int frequencyAt(int place) const;                             // 0 <= place < length()

    // Larger butterflies save passes but spill a processor's registers: ten points were the fastest
    // on llvmpipe. Every radix is a program to compile, and these few come within 5 % of all from 2
    // to 10.
    static constexpr std::array kRadices = {4, 5, 6, 8, 10};

private:
    std::vector<int> radices_;
    int length_ = 1;
};

// The spectrum of a filter with its centre at (0, 0), as the convolution multiplies with it:
// transformed over columns.length() rows of rows.length() points, in the plans' order of
// frequencies, divided by the number of points. Row by row. `filter`: odd sides.
std::vector<std::complex<float>> filterSpectrum(const GreyImage& filter, const FourierPlan& rows, const FourierPlan& columns);

}  // namespace fantascope::render
