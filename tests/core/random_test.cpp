#include "core/random.h"

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <set>
#include <vector>

namespace fantascope {
namespace {

constexpr int kMany = 200'000;

// The moments of kMany values. All bounds are five standard errors wide, and the seeds are fixed.
struct Moments {
    double mean = 0, variance = 0, fourth = 0;  // about the mean; the fourth over the variance squared
};
template <class Draw>
Moments momentsOf(Draw draw) {
    std::vector<double> values(kMany);
    Moments moments;
    for (double& value : values) moments.mean += (value = draw()) / kMany;
    for (const double value : values) moments.variance += std::pow(value - moments.mean, 2) / kMany;
    for (const double value : values) moments.fourth += std::pow(value - moments.mean, 4) / kMany / std::pow(moments.variance, 2);
    return moments;
}

// Computed by an independent implementation of SplitMix64, std::seed_seq (as in the standard) and
// the Mersenne Twister. If these change, every show that was computed before looks different.
TEST(Rng, first_values_are_those_of_every_machine) {
    Rng bits(42), uniform(42), normal(42), below(42);
    for (const std::uint32_t expected : {1763492588u, 1912930480u, 3568202319u, 1523670562u}) EXPECT_EQ(bits.bits(), expected);
    for (const double expected : {0.41059511486730593, 0.8307868417706876, 0.5381602810058629})
        EXPECT_EQ(uniform.uniform(), expected);
    for (const double expected : {0.49980851944357246, -0.8985962857078654}) EXPECT_DOUBLE_EQ(normal.normal(), expected);
    for (const std::uint32_t expected : {4u, 4u, 8u, 3u, 5u, 2u, 0u, 5u}) EXPECT_EQ(below.below(10), expected);
    EXPECT_EQ(Rng(0).bits(), 226486140u);
    EXPECT_EQ(streamSeed(7, {3, 1}), 0x10490351134c1271u);
}

TEST(Rng, uniform_numbers_fill_their_range_evenly) {
    Rng rng(1);
    double least = 1, most = 0;
    const Moments moments = momentsOf([&] {
        const double value = rng.uniform();
        least = std::min(least, value);
        most = std::max(most, value);
        return value;
    });
    EXPECT_NEAR(moments.mean, 0.5, 5 * std::sqrt(1.0 / 12 / kMany));
    EXPECT_NEAR(moments.variance, 1.0 / 12, 5 * std::sqrt(1.0 / 180 / kMany));
    EXPECT_GE(least, 0);
    EXPECT_LT(most, 1);
    EXPECT_LT(least, 1e-4);
    EXPECT_GT(most, 1 - 1e-4);
    const Moments shifted = momentsOf([&] { return rng.uniform(-3, 5); });
    EXPECT_NEAR(shifted.mean, 1, 5 * std::sqrt(64.0 / 12 / kMany));
}

TEST(Rng, normal_numbers_have_the_moments_of_a_normal_distribution) {
    Rng rng(2);
    const Moments moments = momentsOf([&] { return rng.normal(); });
    EXPECT_NEAR(moments.mean, 0, 5 / std::sqrt(kMany));
    EXPECT_NEAR(moments.variance, 1, 5 * std::sqrt(2.0 / kMany));
    EXPECT_NEAR(moments.fourth, 3, 5 * std::sqrt(24.0 / kMany));
}

// Box-Muller gives two numbers at a time; the second must not depend on the first.
TEST(Rng, neighbouring_normal_numbers_do_not_know_each_other) {
    Rng rng(3);
    double product = 0, squares = 0;
    for (int i = 0; i < kMany; ++i) {
        const double a = rng.normal(), b = rng.normal();
        product += a * b / kMany;
        squares += (a * a - 1) * (b * b - 1) / kMany;
    }
    EXPECT_NEAR(product, 0, 5 / std::sqrt(kMany));
    EXPECT_NEAR(squares, 0, 5 * 2 / std::sqrt(kMany));
}

TEST(Rng, each_of_a_few_is_as_likely_as_the_others) {
    Rng rng(4);
    std::array<int, 7> counts{};
    for (int i = 0; i < kMany; ++i) ++counts.at(rng.below(7));
    double chiSquare = 0;
    for (const int count : counts) chiSquare += std::pow(count - kMany / 7.0, 2) / (kMany / 7.0);
    EXPECT_LT(chiSquare, 22.5) << "0.1 % of honest generators exceed this, 6 degrees of freedom";
    EXPECT_EQ(rng.below(1), 0u);
    // For such a count, which does not divide 2^32, a plain remainder would give the first third
    // half of all draws.
    int low = 0;
    for (int i = 0; i < kMany; ++i) low += rng.below(3u << 30) < (1u << 30) ? 1 : 0;
    EXPECT_NEAR(low, kMany / 3.0, 5 * std::sqrt(kMany * 2.0 / 9));
}

TEST(StreamSeed, no_two_identities_share_a_stream) {
    std::set<std::uint64_t> seeds = {streamSeed(5, {})};
    for (std::uint64_t instance = 0; instance < 500; ++instance) {
        seeds.insert(streamSeed(5, {instance}));
        for (std::uint64_t axis = 0; axis < 8; ++axis) seeds.insert(streamSeed(5, {instance, axis}));
    }
    EXPECT_EQ(seeds.size(), 1u + 500 * 9) << "{3, 1} is neither {1, 3} nor {3} nor {3, 1, 0}";
    EXPECT_NE(streamSeed(5, {3, 1}), streamSeed(6, {3, 1}));
    EXPECT_NE(streamSeed(5, {3, 1}), streamSeed(5, {3, 1, 0}));
}

// Two leaves that sway alike would be noticed at once.
TEST(StreamSeed, neighbouring_identities_give_unrelated_streams) {
    constexpr int kStreams = 200, kLength = 1000;
    double product = 0;
    for (std::uint64_t stream = 0; stream < kStreams; ++stream) {
        Rng one(streamSeed(9, {stream, 0})), next(streamSeed(9, {stream + 1, 0}));
        for (int i = 0; i < kLength; ++i) product += one.normal() * next.normal();
    }
    EXPECT_NEAR(product / (kStreams * kLength), 0, 5 / std::sqrt(kStreams * kLength));
}

}  // namespace
}  // namespace fantascope
