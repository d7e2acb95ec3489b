#include "pattern/motion/excitation.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>

namespace fantascope::pattern {
namespace {

constexpr int kFrames = 2000;
constexpr double kRate = 30;
constexpr double kDeviation = 0.1;

// Bins 0 .. N/2 of the Fourier transform by its definition, independent of FFTW.
std::vector<std::complex<double>> transform(const std::vector<double>& samples) {
    const std::size_t count = samples.size();
    std::vector<std::complex<double>> turn(count), bins(count / 2 + 1);
    for (std::size_t i = 0; i < count; ++i)
        turn[i] = std::polar(1.0, -2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count));
    for (std::size_t bin = 0; bin < bins.size(); ++bin)
        for (std::size_t i = 0; i < count; ++i) bins[bin] += samples[i] * turn[bin * i % count];
    return bins;
}

// The slope of log power over log frequency: a least-squares fit over all bins but the first.
double powerSlope(const std::vector<double>& samples) {
    const auto bins = transform(samples);
    double n = 0, x = 0, y = 0, xx = 0, xy = 0;
    for (std::size_t i = 1; i < bins.size(); ++i) {
        const double logFrequency = std::log(static_cast<double>(i)), logPower = std::log(std::norm(bins[i]));
        n += 1, x += logFrequency, y += logPower, xx += logFrequency * logFrequency, xy += logFrequency * logPower;
    }
    return (n * xy - x * y) / (n * xx - x * x);
}

std::vector<double> drawn(double beta, std::uint64_t seed, int frames = kFrames, double deviation = kDeviation) {
    Rng rng(seed);
    return Excitation(beta, frames, kRate, deviation).draw(rng);
}

// The amplitudes fall as 1/f^beta, so the power falls as 1/f^(2 beta).
// Example failure: amplitudes drawn as the square root of the model give half the slope.
TEST(Excitation, power_falls_as_frequency_to_minus_two_beta) {
    for (const double beta : {0.0, 1.0, 2.0})
        for (std::uint64_t seed = 1; seed <= 5; ++seed) {
            EXPECT_NEAR(powerSlope(drawn(beta, seed)), -2 * beta, 0.05) << "beta " << beta << ", seed " << seed;
        }
}

// "We need shape instances to fluctuate around their original position and have no static offset."
TEST(Excitation, has_mean_zero) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        const auto force = drawn(2, seed);
        EXPECT_NEAR(std::accumulate(force.begin(), force.end(), 0.0) / kFrames, 0.0, 1e-14);
    }
}

TEST(Excitation, has_a_peak_of_one_on_either_side) {
    bool above = false, below = false;
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
        const auto force = drawn(1, seed);
        const auto [low, high] = std::minmax_element(force.begin(), force.end());
        EXPECT_EQ(std::max(-*low, *high), 1.0);
        above |= *high == 1.0;
        below |= *low == -1.0;
    }
    EXPECT_TRUE(above && below) << "normalised by the maximum or the minimum instead of the peak";
}

// The bin at half the rate is its own conjugate and must be real; a complex one would lose its
// imaginary part. Example failure: with a random phase, the last bin's amplitude is multiplied by
// |cos(phase)|.
TEST(Excitation, keeps_the_amplitude_of_the_last_bin) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        const auto bins = transform(drawn(1, seed, 64, 0.0));
        EXPECT_NEAR(std::abs(bins[32]) / std::abs(bins[1]), 1.0 / 32, 1e-12) << "seed " << seed;
        EXPECT_NEAR(bins[32].imag(), 0.0, 1e-12);
    }
}

// The relative spread of an amplitude about its mean is m: the paper's "variance sigma = m mu" is a
// standard deviation. Example failure: with a variance of m mu, the spread of bin 1 (mu = 66.7)
// would be 1/8 of that, and the spread of bin 1000 (mu = .067) four times as much.
TEST(Excitation, scatters_amplitudes_relative_to_their_mean) {
    const auto bins = transform(drawn(1, 11));
    double sum = 0, squares = 0;
    for (std::size_t i = 1; i < bins.size(); ++i) {
        const double flattened = std::abs(bins[i]) * static_cast<double>(i);
        sum += flattened;
        squares += flattened * flattened;
    }
    const double count = static_cast<double>(bins.size() - 1), mean = sum / count;
    EXPECT_NEAR(std::sqrt(squares / count - mean * mean) / mean, kDeviation, 0.01);
}

// Amplitudes that would be negative become 0. If all are 0, the excitation is 0, without a division
// by zero.
TEST(Excitation, is_finite_for_a_deviation_that_silences_bins) {
    bool calm = false;
    for (std::uint64_t seed = 1; seed <= 200; ++seed) {
        const auto force = drawn(1, seed, 4, 3.0);
        for (const double sample : force) ASSERT_TRUE(std::isfinite(sample)) << "seed " << seed;
        calm |= std::all_of(force.begin(), force.end(), [](double sample) { return sample == 0; });
    }
    EXPECT_TRUE(calm) << "no seed reached the case that this test is for";
}

TEST(Excitation, depends_on_the_stream_alone) {
    EXPECT_EQ(drawn(1, 7), drawn(1, 7));
    EXPECT_NE(drawn(1, 7), drawn(1, 8));
    // One stream gives one force after another, each different.
    Rng rng(7);
    const Excitation excitation(1, kFrames, kRate, kDeviation);
    const auto first = excitation.draw(rng), second = excitation.draw(rng);
    EXPECT_EQ(first, drawn(1, 7));
    EXPECT_NE(first, second);
}

}  // namespace
}  // namespace fantascope::pattern
