#include "pattern/motion/harmonic_motion.h"

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fantascope::pattern {
namespace {

constexpr double kStep = 1.0 / 30;

struct OscillatorCase {
    double naturalFrequency, damping;
};
// Slow and fast relative to the 30 Hz of the samples, nearly undamped and nearly critical.
constexpr OscillatorCase kOscillators[] = {{0.02, 0.3}, {0.25, 0.35}, {1.0, 0.02}, {1.0, 0.2},
                                           {0.8, 0.99}, {4.0, 0.1},   {14.0, 0.5}};

std::vector<double> excitation(double beta, int frames, std::uint64_t seed) {
    Rng rng(seed);
    return Excitation(beta, frames, 1 / kStep, 0.1).draw(rng);
}

// Solves the equation of motion over one sample interval in `substeps` steps of the classical
// Runge-Kutta method; calls see(fraction, state) after each. It shares nothing with the recurrence
// under test.
template <class See>
MotionState rungeKutta(OscillatorCase oscillator, MotionState state, double before, double after, int substeps, See see) {
    const double w = 2 * std::numbers::pi * oscillator.naturalFrequency;
    const auto derivative = [&](MotionState at, double fraction) {
        const double force = before + (after - before) * fraction;
        return MotionState(at.y, w * w * (force - at.x) - 2 * oscillator.damping * w * at.y);
    };
    const double h = kStep / substeps;
    for (int i = 0; i < substeps; ++i) {
        const double start = static_cast<double>(i) / substeps, end = (i + 1.0) / substeps, middle = (start + end) / 2;
        const MotionState a = derivative(state, start), b = derivative(state + 0.5 * h * a, middle),
                          c = derivative(state + 0.5 * h * b, middle), d = derivative(state + h * c, end);
        state += h / 6 * (a + 2.0 * b + 2.0 * c + d);
        see(end, state);
    }
    return state;
}

// Velocities are compared relative to the natural angular frequency, so that one bound serves slow
// and fast oscillators.
double difference(MotionState a, MotionState b, OscillatorCase oscillator) {
    return std::max(std::abs(a.x - b.x), std::abs(a.y - b.y) / (2 * std::numbers::pi * oscillator.naturalFrequency));
}

double displacement(std::span<const MotionState> loop, std::size_t index, double fraction) {
    const auto [a, b, c, d] = hermiteWeights(fraction);
    const MotionState from = loop[index], to = loop[(index + 1) % loop.size()];
    return a * from.x + b * kStep * from.y + c * to.x + d * kStep * to.y;
}

// Example failure: a sum over samples instead of Duhamel's integral is off by several per cent at
// these steps.
TEST(Oscillator, follows_the_equation_of_motion_to_1e_9) {
    constexpr std::size_t kFrames = 300;
    const auto force = excitation(1, kFrames, 3);
    for (const OscillatorCase& oscillator : kOscillators) {
        const auto loop = Oscillator(oscillator.naturalFrequency, oscillator.damping).steadyState(force, kStep);
        MotionState state = loop[0];
        double worst = 0;
        for (std::size_t i = 0; i < kFrames; ++i) {
            worst = std::max(worst, difference(state, loop[i], oscillator));
            state = rungeKutta(oscillator, state, force[i], force[(i + 1) % kFrames], 256, [](double, MotionState) {});
        }
        EXPECT_LT(worst, 1e-9) << oscillator.naturalFrequency << " Hz, damping " << oscillator.damping;
    }
}

// One more loop equals the first, in displacement and in velocity.
// Example failure: started from rest, the first loop differs from the second for many seconds, and
// the film jumps where it repeats.
TEST(Oscillator, repeats_without_a_seam) {
    constexpr std::size_t kFrames = 300;
    const auto force = excitation(2, kFrames, 4);
    for (const OscillatorCase& oscillator : kOscillators) {
        const auto loop = Oscillator(oscillator.naturalFrequency, oscillator.damping).steadyState(force, kStep);
        MotionState state = loop[0];
        for (std::size_t i = 0; i < kFrames; ++i)
            state = rungeKutta(oscillator, state, force[i], force[(i + 1) % kFrames], 256, [](double, MotionState) {});
        EXPECT_LT(difference(state, loop[0], oscillator), 1e-9)
            << oscillator.naturalFrequency << " Hz, damping " << oscillator.damping;
    }
}

TEST(Oscillator, moves_by_one_under_a_steady_unit_force) {
    const std::vector<double> force(100, 1.0);
    for (const OscillatorCase& oscillator : kOscillators)
        for (const MotionState& state : Oscillator(oscillator.naturalFrequency, oscillator.damping).steadyState(force, kStep)) {
            EXPECT_NEAR(state.x, 1.0, 1e-12);
            EXPECT_NEAR(state.y, 0.0, 1e-10);
        }
}

TEST(Oscillator, answers_twice_the_force_with_twice_the_movement) {
    auto force = excitation(1, 200, 5);
    const Oscillator oscillator(1.0, 0.2);
    const auto once = oscillator.steadyState(force, kStep);
    for (double& sample : force) sample *= 2;
    const auto twice = oscillator.steadyState(force, kStep);
    for (std::size_t i = 0; i < once.size(); ++i) EXPECT_EQ(twice[i], 2.0 * once[i]);
}

// A free vibration has the frequency sqrt(1 - damping^2) w and decays as exp(-damping w t).
TEST(Oscillator, vibrates_freely_as_in_closed_form) {
    const double w = 2 * std::numbers::pi * 0.5, damping = 0.1,
                 period = 2 * std::numbers::pi / (w * std::sqrt(1 - damping * damping));
    const MotionState after = Oscillator(0.5, damping).freeVibration(period) * MotionState(1, -0.3);
    const double left = std::exp(-damping * w * period);
    EXPECT_NEAR(after.x, left, 1e-12);
    EXPECT_NEAR(after.y, -0.3 * left, 1e-12);
}

// Between the samples the curve is not exact. With the oscillators of the default settings, its
// error is at most 4e-6 of the displacement by a constant force of the same peak: a thousandth of a
// pixel in 250.
TEST(Hermite, stays_near_the_equation_of_motion_between_samples) {
    constexpr std::size_t kFrames = 300;
    constexpr int kSubsteps = 32;
    const MotionSettings settings;
    for (const AxisMotion& axis :
         {settings.groupMajor, settings.groupMinor, settings.localTranslation, settings.localTilt, settings.localTurn}) {
        const OscillatorCase oscillator{axis.naturalFrequency, axis.damping};
        const auto force = excitation(axis.beta, kFrames, 6);
        const auto loop = Oscillator(oscillator.naturalFrequency, oscillator.damping).steadyState(force, kStep);
        double worst = 0;
        for (std::size_t i = 0; i < kFrames; ++i)
            rungeKutta(oscillator, loop[i], force[i], force[(i + 1) % kFrames], kSubsteps,
                       [&](double fraction, MotionState state) {
                           worst = std::max(worst, std::abs(state.x - displacement(loop, i, fraction)));
                       });
        EXPECT_LT(worst, 4e-6) << oscillator.naturalFrequency << " Hz";
    }
}

// A peak between samples counts: the curve between two samples at displacement 0 with opposite
// velocities is an arc.
TEST(Hermite, peak_is_that_of_the_curve_not_of_the_samples) {
    // u(s) = s (1 - s) on the first interval, its reflection on the second.
    const double slope = 1 / kStep;
    const std::vector<MotionState> arcs{{0, slope}, {0, -slope}};
    EXPECT_NEAR(peakDisplacement(arcs, kStep), 0.25, 1e-15);
}

TEST(Hermite, peak_matches_a_dense_search) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        // Few samples per swing, so that the peak lies far from them.
        const auto loop = Oscillator(6.0, 0.3).steadyState(excitation(0, 16, seed), kStep);
        double dense = 0;
        for (std::size_t i = 0; i < loop.size(); ++i)
            for (int k = 0; k <= 2000; ++k) dense = std::max(dense, std::abs(displacement(loop, i, k / 2000.0)));
        const double peak = peakDisplacement(loop, kStep);
        EXPECT_GE(peak, dense - 1e-15);
        EXPECT_NEAR(peak, dense, 1e-6 * dense);
    }
}

MotionSettings shortLoop() {
    MotionSettings settings;
    settings.frames = 300;
    return settings;
}

std::vector<MotionState> drawn(const AxisMotion& axis, std::uint64_t seed) {
    Rng rng(seed);
    return HarmonicMotion(axis, shortLoop()).draw(rng);
}

// Example failure: scaled by the largest sample, the curve still exceeds the range between samples.
TEST(HarmonicMotion, reaches_its_range_but_never_leaves_it) {
    const AxisMotion axis{0, 5.0, 0.2, 1.0, 0.01};
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        const auto loop = drawn(axis, seed);
        double peak = 0;
        for (std::size_t i = 0; i < loop.size(); ++i)
            for (int k = 0; k < 200; ++k) peak = std::max(peak, std::abs(displacement(loop, i, k / 200.0)));
        EXPECT_LE(peak, axis.range * (1 + 1e-12));
        EXPECT_GT(peak, axis.range * (1 - 1e-3));
    }
}

// The range scales a movement as a whole. Example failure: a clamp flattens the tops, and shapes
// stick at their range.
TEST(HarmonicMotion, keeps_the_shape_of_a_movement_that_its_range_scales_down) {
    AxisMotion axis{1, 1.0, 0.2, 1.0, 1000.0};
    const auto freely = drawn(axis, 2);
    const double peak = peakDisplacement(freely, kStep);
    axis.range = peak / 3;
    const auto held = drawn(axis, 2);
    for (std::size_t i = 0; i < held.size(); ++i) {
        EXPECT_NEAR(held[i].x, freely[i].x / 3, 1e-14);
        EXPECT_NEAR(held[i].y, freely[i].y / 3, 1e-12);
    }
}

// Within its range a movement follows its magnitude; the range never makes it larger.
TEST(HarmonicMotion, is_proportional_to_the_magnitude_within_its_range) {
    AxisMotion axis{1, 1.0, 0.2, 0.001, 1000.0};
    const auto small = drawn(axis, 2);
    axis.magnitude = 0.002;
    const auto large = drawn(axis, 2);
    for (std::size_t i = 0; i < small.size(); ++i) EXPECT_NEAR(large[i].x, 2 * small[i].x, 1e-15);
    EXPECT_LT(peakDisplacement(large, kStep), 0.02);
}

TEST(HarmonicMotion, stands_still_with_a_magnitude_or_a_range_of_zero) {
    for (const AxisMotion& axis :
         {AxisMotion{1, 1.0, 0.2, 0.0, 1.0}, AxisMotion{1, 1.0, 0.2, 1.0, 0.0}, AxisMotion{1, 1.0, 0.2, 0.0, 0.0}})
        for (const MotionState& state : drawn(axis, 2)) EXPECT_EQ(state, MotionState(0));
}

}  // namespace
}  // namespace fantascope::pattern
