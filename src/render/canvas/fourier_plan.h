#pragma once

#include "media/image.h"

#include <glm/vec2.hpp>

#include <array>
#include <complex>
#include <vector>

namespace fantascope::render {

// How a Fourier transform is split into passes of small radices, and where it leaves each
// frequency. assets/shaders/convolve.comp runs the passes in place and never reorders.
class FourierPlan {
public:
    // The cheapest transform of at least `points` (> 0) points, by the product of points and
    // passes.
    explicit FourierPlan(int points);

    int length() const { return length_; }                        // the product of the radices
    const std::vector<int>& radices() const { return radices_; }  // of the forward passes, each one of kRadices
    int frequencyAt(int place) const;                             // after the forward passes; 0 <= place < length()

    // Larger butterflies save passes but spill registers; ten points were the fastest on llvmpipe.
    // Every radix is a program to compile, and these few are within 5 % of using all radices from 2
    // to 10.
    static constexpr std::array kRadices = {4, 5, 6, 8, 10};

private:
    std::vector<int> radices_;
    int length_ = 1;
};

// The spectrum of a filter with its centre at (0, 0), as the convolution needs it: columns.length()
// rows of rows.length() points, row by row, in the plans' order of frequencies, divided by the
// number of points. `filter`: both sides odd.
std::vector<std::complex<float>> filterSpectrum(const GreyImage& filter, const FourierPlan& rows, const FourierPlan& columns);

}  // namespace fantascope::render
