#include "render/source/water.h"

#include "core/check.h"
#include "core/random.h"

#include <glm/geometric.hpp>

#include <cmath>
#include <numbers>

namespace fantascope::render {
namespace {

constexpr double kGravity = 9.81, kRefraction = 1.333;
constexpr double kOctave = 2;  // wave lengths are between 1/2 and 2 times the mean
constexpr double kTurn = 2 * std::numbers::pi;

}  // namespace

Water::Water(const CausticsSource& source) {
    Rng rng(source.seed);
    double variance = 0;
    for (int i = 0; i < kWaves; ++i) {
        // Directions and lengths are evenly spread, so that the waves form no lattice.
        const double direction = kTurn * (i + rng.uniform()) / kWaves;
        const double length = source.waveLength * std::pow(kOctave, rng.uniform(-1, 1));
        const double k = kTurn / length;
        // Waves of all lengths focus equally: their curvature, height k^2, is the same.
        const double height = 1 / (k * k);
        variance += height * height / 2;
        waves_.push_back({k * glm::dvec2(std::cos(direction), std::sin(direction)), height,
                          std::sqrt(kGravity * k * std::tanh(k * source.depth)), rng.uniform(0, kTurn)});
    }
    const double scale = source.waveHeight / std::sqrt(variance), bend = source.depth * (1 - 1 / kRefraction);
    double reach = 0;
    for (Wave& wave : waves_) {
        const double metres = bend * scale * wave.strength;
        reach += std::pow(metres * glm::length(wave.k), 2) / 2;
        wave.strength = metres / (source.size.y * source.size.y);
        wave.k *= source.size.y;
    }
    reach_ = 4 * std::sqrt(reach) / source.size.y;
    shortestWave_ = source.waveLength / kOctave / source.size.y;
}

void Water::at(Time time, std::span<glm::vec4> out) const {
    FANTASCOPE_CHECK(out.size() == waves_.size(), "there is one place per wave");
    for (std::size_t i = 0; i < waves_.size(); ++i) {
        const Wave& wave = waves_[i];
        out[i] = glm::vec4(glm::dvec4(wave.k, wave.strength, std::fmod(wave.phase - wave.omega * seconds(time), kTurn)));
    }
}

}  // namespace fantascope::render
