#pragma once

#include "pattern/motion/excitation.h"
#include "pattern/shape/motion_settings.h"

#include "core/random.h"

#include <glm/mat2x2.hpp>
#include <glm/vec2.hpp>

#include <array>
#include <span>
#include <vector>

namespace fantascope::pattern {

// The state of a moving point: x is its displacement, y its velocity (displacement per second).
using MotionState = glm::dvec2;

// A damped oscillator with one degree of freedom and unit stiffness: u'' + 2 damping w u' + w^2 u =
// w^2 force, with w = 2 pi naturalFrequency. A constant unit force displaces it by 1.
class Oscillator {
public:
    // naturalFrequency in Hz, > 0; 0 < damping < 1 (underdamped), relative to critical damping.
    Oscillator(double naturalFrequency, double damping);

    // state(t + time) = freeVibration(time) * state(t) when no force acts.
    glm::dmat2 freeVibration(double time) const;
    // One period of the steady-state response to a periodic force. The last state leads into the
    // first without a seam, in displacement and in velocity. The force is linear between its
    // samples, which are `step` seconds apart; Duhamel's integral is exact for it (Craig & Kurdila
    // 2006; Ji et al. 2015, section 4.2, stage 2).
    std::vector<MotionState> steadyState(std::span<const double> force, double step) const;

private:
    double angularFrequency_;  // radians a second
    double damping_;
};

// The weights of the cubic Hermite curve from one state to the next, at `fraction` (0..1) of the
// way. They multiply, in this order, the first state's displacement and step * velocity, and the
// second state's displacement and step * velocity.
std::array<double, 4> hermiteWeights(double fraction);

// The largest |displacement| of the closed Hermite curve through states `step` seconds apart. It is
// exact between the states too.
double peakDisplacement(std::span<const MotionState> loop, double step);

// Harmonic motion along one axis: excitation, oscillator and range together. Thread: every const
// method is reentrant.
class HarmonicMotion {
public:
    HarmonicMotion(const AxisMotion& axis, const MotionSettings& settings);

    // A random trajectory without a seam: settings.frames states at settings.rate Hz. If its
    // Hermite curve would exceed axis.range, the whole trajectory is scaled down.
    std::vector<MotionState> draw(Rng& rng) const;

private:
    AxisMotion axis_;
    double step_;  // seconds
    Excitation excitation_;
    Oscillator oscillator_;
};

}  // namespace fantascope::pattern
