#pragma once

#include "core/random.h"

#include <memory>
#include <vector>

namespace fantascope::pattern {

// Random forces that resemble a breeze. Their amplitude spectrum falls as 1/f^beta, so their power
// falls as 1/f^(2 beta).
// Source: Ji et al. 2015, section 4.2, stage 1. The paper says that the samples "are in the range
// of [0, 1]", which is impossible for a signal with mean 0. Here the largest absolute value is 1.
// Thread: every const method is reentrant.
class Excitation {
public:
    // `frames`: samples in a period; even, >= 4. `rate`: Hz, > 0. `deviation`: standard deviation
    // of each spectral amplitude relative to its mean, >= 0. It is the paper's m << 1, whose
    // "variance sigma = m mu" is a standard deviation. `beta`: >= 0.
    Excitation(double beta, int frames, double rate, double deviation);
    Excitation(Excitation&&) noexcept;
    ~Excitation();

    // One period of a force: mean 0, largest absolute value 1, no seam when it repeats.
    std::vector<double> draw(Rng& rng) const;

private:
    class InverseTransform;
    int frames_;
    double deviation_;
    std::vector<double> meanAmplitude_;  // of bins 0 .. frames / 2
    std::unique_ptr<const InverseTransform> inverse_;
};

}  // namespace fantascope::pattern
