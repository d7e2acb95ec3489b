#pragma once

#include "core/random.h"

#include <memory>
#include <vector>

namespace fantascope::pattern {

// Random forces that resemble a breeze: their amplitude spectrum falls as 1/f^beta, so their power
// falls as 1/f^(2 beta).
// Source: Ji et al. 2015, section 4.2, stage 1. There the samples "are in the range of [0, 1]",
// which a signal without an offset cannot be; here the peak is 1 on either side of 0. Thread: every
// const method is reentrant.
class Excitation {
public:
    // Forces of `frames` (even, >= 4) samples at `rate` (> 0) Hz. `deviation` (>= 0, the paper's m
    // << 1) is the spread of each spectral amplitude relative to its mean: the paper's "variance
    // sigma = m mu" is a standard deviation. beta >= 0.
    Excitation(double beta, int frames, double rate, double deviation);
    Excitation(Excitation&&) noexcept;
    ~Excitation();

    // One period of a force: mean 0, peak 1, no seam when it is repeated.
    std::vector<double> draw(Rng& rng) const;

private:
    class InverseTransform;
    int frames_;
    double deviation_;
    std::vector<double> meanAmplitude_;  // of bins 0 .. frames / 2
    std::unique_ptr<const InverseTransform> inverse_;
};

}  // namespace fantascope::pattern
