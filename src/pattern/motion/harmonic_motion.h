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

// The state of a moving point: x is its displacement, y its velocity (displacement a second).
using MotionState = glm::dvec2;

// A damped oscillator with one degree of freedom and unit stiffness, u'' + 2 damping w u' + w^2 u =
// w^2 force with w = 2 pi naturalFrequency: a steady unit force moves it by 1.
class Oscillator {
public:
    // naturalFrequency in Hz, > 0; 0 < damping < 1 (underdamped), relative to critical damping.
    Oscillator(double naturalFrequency, double damping);

    // state(t + time) = freeVibration(time) * state(t) when no force acts.
    glm::dmat2 freeVibration(double time) const;
    // One period of the movement that a periodic force drives once every trace of a beginning has
    // died away: after the last sample comes the first again, in displacement and velocity. The
    // force is linear between its samples, `step` seconds apart, and Duhamel's integral is exact
    // for it (Craig & Kurdila 2006; Ji et al. 2015, section 4.2, stage 2).
    std::vector<MotionState> steadyState(std::span<const double> force, double step) const;

private:
    double angularFrequency_;  // radians a second
    double damping_;
};

// The cubic Hermite curve from one state to the next, `fraction` (0..1) of the way between them:
// its displacement is the sum of the weights times {displacement, step * velocity} of the first and
// {displacement, step * velocity} of the second state.
std::array<double, 4> hermiteWeights(double fraction);

// The largest |displacement| of the closed Hermite curve through states `step` seconds apart;
// exact, between the states too.
double peakDisplacement(std::span<const MotionState> loop, double step);

// One direction of harmonic motion: excitation, oscillator and range together. Thread: every const
// method is reentrant.
class HarmonicMotion {
public:
    HarmonicMotion(const AxisMotion& axis, const MotionSettings& settings);

    // A trajectory of its own for each state of `rng`: settings.frames states at settings.rate Hz,
    // without a seam. Their Hermite curve stays within axis.range, for it is scaled down as a whole
    // where it would not.
    std::vector<MotionState> draw(Rng& rng) const;

private:
    AxisMotion axis_;
    double step_;  // seconds
    Excitation excitation_;
    Oscillator oscillator_;
};

}  // namespace fantascope::pattern
