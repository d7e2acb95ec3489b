#include "core/random.h"

#include <cmath>
#include <numbers>

namespace fantascope {
namespace {

// SplitMix64 (Steele, Lea & Flood 2014): each step is a bijection that mixes all 64 bits.
std::uint64_t mix(std::uint64_t value) {
    value += 0x9e3779b97f4a7c15u;
    value = (value ^ (value >> 30)) * 0xbf58476d1ce4e5b9u;
    value = (value ^ (value >> 27)) * 0x94d049bb133111ebu;
    return value ^ (value >> 31);
}

}  // namespace

Rng::Rng(std::uint64_t seed) {
    const std::uint64_t mixed = mix(seed);
    std::seed_seq sequence{static_cast<std::uint32_t>(mixed), static_cast<std::uint32_t>(mixed >> 32)};
    engine_.seed(sequence);
}

double Rng::uniform() {
    const std::uint64_t high = engine_() >> 5, low = engine_() >> 6;
    return static_cast<double>((high << 26) | low) * 0x1p-53;
}

double Rng::uniform(double low, double high) { return low + (high - low) * uniform(); }

double Rng::normal() {
    if (hasSpare_) {
        hasSpare_ = false;
        return spare_;
    }
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));  // 1 - u is in (0, 1]
    const double angle = 2.0 * std::numbers::pi * uniform();
    spare_ = radius * std::sin(angle);
    hasSpare_ = true;
    return radius * std::cos(angle);
}

std::uint32_t Rng::below(std::uint32_t count) {
    // Lemire 2019: a multiplication, and rejection of the few values that would favour some
    // results.
    const std::uint32_t threshold = -count % count;
    for (;;) {
        const std::uint64_t product = std::uint64_t{bits()} * count;
        if (static_cast<std::uint32_t>(product) >= threshold) return static_cast<std::uint32_t>(product >> 32);
    }
}

std::uint64_t streamSeed(std::uint64_t seed, std::initializer_list<std::uint64_t> identity) {
    std::uint64_t state = mix(seed);
    for (const std::uint64_t part : identity) state = mix(state ^ part);
    return state;
}

}  // namespace fantascope
