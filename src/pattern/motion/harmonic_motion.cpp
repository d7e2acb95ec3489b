#include "pattern/motion/harmonic_motion.h"

#include "core/check.h"

#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fantascope::pattern {
namespace {

// The largest |displacement| of one Hermite segment.
double segmentPeak(MotionState from, MotionState to, double step) {
    const double slopeFrom = step * from.y, slopeTo = step * to.y;
    const double ends = std::max(std::abs(from.x), std::abs(to.x));
    // displacement(s) = a s^3 + b s^2 + slopeFrom s + from.x; its extrema are the roots of 3 a s^2
    // + 2 b s + slopeFrom, computed without cancellation.
    const double a = 2 * (from.x - to.x) + slopeFrom + slopeTo;
    const double b = 3 * (to.x - from.x) - 2 * slopeFrom - slopeTo;
    const double discriminant = b * b - 3 * a * slopeFrom;
    if (discriminant <= 0) return ends;
    const double q = -(b + std::copysign(std::sqrt(discriminant), b));
    double peak = ends;
    for (const double s : {q / (3 * a), slopeFrom / q})
        if (s > 0 && s < 1) peak = std::max(peak, std::abs(((a * s + b) * s + slopeFrom) * s + from.x));
    return peak;
}

}  // namespace

Oscillator::Oscillator(double naturalFrequency, double damping)
    : angularFrequency_(2 * std::numbers::pi * naturalFrequency), damping_(damping) {
    FANTASCOPE_CHECK(naturalFrequency > 0, "an oscillator's natural frequency must be > 0 Hz");
    FANTASCOPE_CHECK(damping > 0 && damping < 1, "an oscillator's damping must be > 0 and < 1");
}

glm::dmat2 Oscillator::freeVibration(double time) const {
    const double decay = damping_ * angularFrequency_;
    const double dampedFrequency = angularFrequency_ * std::sqrt(1 - damping_ * damping_);
    const double envelope = std::exp(-decay * time);
    const double cosine = envelope * std::cos(dampedFrequency * time);
    const double sine = envelope * std::sin(dampedFrequency * time) / dampedFrequency;
    return {cosine + decay * sine, -angularFrequency_ * angularFrequency_ * sine,  // the response to a unit displacement
            sine, cosine - decay * sine};                                          // the response to a unit velocity
}

std::vector<MotionState> Oscillator::steadyState(std::span<const double> force, double step) const {
    const std::size_t frames = force.size();
    const glm::dmat2 free = freeVibration(step);
    std::vector<MotionState> loop(frames);

    // Fills the loop from its first state on and returns the state after the last. Under a force
    // with a constant slope, one solution follows the force at a constant lag with that slope as
    // its velocity. The difference between the state and that solution vibrates freely.
    const auto follow = [&](MotionState state) {
        for (std::size_t i = 0; i < frames; ++i) {
            loop[i] = state;
            const double before = force[i], after = force[(i + 1) % frames];
            const double slope = (after - before) / step;
            const double lag = 2 * damping_ / angularFrequency_ * slope;
            state = MotionState(after - lag, slope) + free * (state - MotionState(before - lag, slope));
        }
        return state;
    };

    // One period takes a first state x to fromRest + freeVibration(period) x. The steady state is
    // the fixed point of that map.
    const MotionState fromRest = follow(MotionState(0));
    follow(glm::inverse(glm::dmat2(1) - freeVibration(static_cast<double>(frames) * step)) * fromRest);
    return loop;
}

std::array<double, 4> hermiteWeights(double fraction) {
    const double s = fraction, r = 1 - fraction;
    return {r * r * (1 + 2 * s), s * r * r, s * s * (1 + 2 * r), -s * s * r};
}

double peakDisplacement(std::span<const MotionState> loop, double step) {
    double peak = 0;
    for (std::size_t i = 0; i < loop.size(); ++i) {
        const MotionState from = loop[i], to = loop[(i + 1) % loop.size()];
        // Between its ends a segment overshoots them by at most 4/27 of each slope, so few segments
        // can raise the peak.
        const double bound = std::max(std::abs(from.x), std::abs(to.x)) + 4.0 / 27 * step * (std::abs(from.y) + std::abs(to.y));
        if (bound > peak) peak = std::max(peak, segmentPeak(from, to, step));
    }
    return peak;
}

HarmonicMotion::HarmonicMotion(const AxisMotion& axis, const MotionSettings& settings)
    : axis_(axis),
      step_(1 / settings.rate),
      excitation_(axis.beta, settings.frames, settings.rate, settings.deviation),
      oscillator_(axis.naturalFrequency, axis.damping) {}

std::vector<MotionState> HarmonicMotion::draw(Rng& rng) const {
    std::vector<MotionState> loop = oscillator_.steadyState(excitation_.draw(rng), step_);
    // The oscillator is linear, so the magnitude may be applied after it. The range is kept by
    // scaling and not by clamping, which would make shapes stick.
    const double peak = axis_.magnitude * peakDisplacement(loop, step_);
    const double scale = peak > axis_.range ? axis_.magnitude * axis_.range / peak : axis_.magnitude;
    for (MotionState& state : loop) state *= scale;
    return loop;
}

}  // namespace fantascope::pattern
