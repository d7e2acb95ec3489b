#pragma once

#include "render/source/picture_source.h"

#include "core/clock.h"

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include <span>
#include <vector>

namespace fantascope::render {

// Water waves and how they refract light: a sum of plane gravity waves from all directions (omega^2
// = g k tanh(k depth)) over a floor, lit and seen from above. Rays are deflected by (1 - 1/n) times
// the slope, which holds for small slopes. Lengths in canvas heights: [0, aspect] x [0, 1].
class Water {
public:
    static constexpr int kWaves = 24;
    explicit Water(const CausticsSource& source);

    // Fills `out` with the kWaves waves at show time `time`: wave vector k, strength b and phase p.
    // The ray that passes the surface at x meets the floor at x - sum of b k sin(k x + p), so rays
    // converge under crests. A function of the time alone. Does not allocate.
    void at(Time time, std::span<glm::vec4> out) const;

    double shortestWave() const { return shortestWave_; }
    // Four standard deviations of a ray's horizontal shift between surface and floor: practically
    // its maximum.
    double reach() const { return reach_; }

private:
    struct Wave {
        glm::dvec2 k;
        double strength, omega, phase;
    };
    std::vector<Wave> waves_;
    double shortestWave_ = 0, reach_ = 0;
};

}  // namespace fantascope::render
