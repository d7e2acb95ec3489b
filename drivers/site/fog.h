#pragma once

#include <cmath>

namespace fantascope::site {

// The share of light that passes through `path` metres of fog (Beer-Lambert law). `fog`: extinction
// per metre, >= 0.
inline float transmitted(double fog, float path) { return fog > 0 ? std::exp(-static_cast<float>(fog) * path) : 1.0f; }

}  // namespace fantascope::site
