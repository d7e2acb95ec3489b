#include "show/course/wind.h"

#include "core/random.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fantascope::show {
namespace {

constexpr double kLag = 0.5;                   // seconds, of each of the two lags
constexpr std::uint64_t kGustStream = 0x6701;  // of the show's seed
constexpr double kSlowestGust = 0.05;          // Hz; each wave is about an octave above the previous one
constexpr double kScatter = 0.15;              // of the frequencies, as a share, so that they have no common period

// A value that follows the wanted value, `asked` + `rate` * time, through both lags: first' =
// (asked - first) / lag, second' = (first - second) / lag. The solution is exact.
struct Followed {
    double asked, first, second;

    Followed after(double time, double rate) const {
        const double decay = std::exp(-time / kLag);
        const double firstOff = first - asked + rate * kLag, secondOff = second - asked + 2 * rate * kLag;
        return {asked + rate * time, asked + rate * (time - kLag) + firstOff * decay,
                asked + rate * (time - 2 * kLag) + (secondOff + firstOff * time / kLag) * decay};
    }
};

}  // namespace

Gusts::Gusts(std::uint64_t seed) {
    Rng rng(streamSeed(seed, {kGustStream}));
    double frequency = kSlowestGust, sum = 0;
    for (Wave& wave : waves_) {
        const double own = frequency * rng.uniform(1 - kScatter, 1 + kScatter);
        wave = {1 / std::sqrt(own), 2 * std::numbers::pi * own, rng.uniform(-std::numbers::pi, std::numbers::pi)};
        sum += wave.amplitude;
        frequency *= 2;
    }
    for (Wave& wave : waves_) wave.amplitude /= sum;
}

double Gusts::lullAt(Time time) const {
    double lull = 0.5;
    for (const Wave& wave : waves_) lull += 0.5 * wave.amplitude * std::sin(wave.angularFrequency * seconds(time) + wave.phase);
    return std::clamp(lull, 0.0, 1.0);  // against rounding errors only: the sum of the amplitudes is 1
}

WindCourse::WindCourse(const WindWish& wish) : target_(valuesOf(wish)) { from_ = {target_, target_, target_}; }

WindCourse::WindCourse(const WindCourse& before, const WindWish& wish, Time start, Time fade)
    : start_(start), fade_(fade), from_(before.stateAt(start)), target_(valuesOf(wish)) {
    if (fade == Time::zero()) from_.asked = target_;
}

WindCourse::Values WindCourse::valuesOf(const WindWish& wish) {
    if (!wish.direction) return {wish.strength, wish.gusts, 1, 0, 0};
    return {wish.strength, wish.gusts, 0, std::cos(*wish.direction), std::sin(*wish.direction)};
}

WindCourse::State WindCourse::stateAt(Time time) const {
    const double fade = seconds(fade_), elapsed = seconds(time - start_);
    State state;
    for (std::size_t i = 0; i < target_.size(); ++i) {
        Followed value{from_.asked[i], from_.first[i], from_.second[i]};
        if (fade > 0) value = value.after(std::min(elapsed, fade), (target_[i] - value.asked) / fade);
        if (elapsed >= fade) {
            value.asked = target_[i];
            value = value.after(elapsed - fade, 0);
        }
        state.asked[i] = value.asked;
        state.first[i] = value.first;
        state.second[i] = value.second;
    }
    return state;
}

Wind WindCourse::at(Time time, double lull) const {
    const auto [strength, gusts, ownDirection, x, y] = stateAt(time).second;
    return {strength * (1 - gusts * lull), ownDirection, {x, y}};
}

}  // namespace fantascope::show
