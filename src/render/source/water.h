#pragma once

#include "render/source/picture_source.h"

#include "core/clock.h"

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include <span>
#include <vector>

namespace fantascope::render {

// Waves on water and how they bend light: a sum of plane waves from all directions, each as fast as
// gravity makes it (omega^2 = g k tanh(k depth)), over a floor that is looked at from above in
// sunlight from above. Rays are bent by (1 - 1/n) times the slope, which holds for waves that are
// not steep. Lengths in canvas heights: [0, aspect] x [0, 1].
class Water {
public:
    static constexpr int kWaves = 24;
    explicit Water(const CausticsSource& source);

    // Of each wave at show time `time`: the wave vector k, a strength b and a phase p, so that the
    // ray that passes the surface at x meets the floor at x - sum of b k sin(k x + p): under a
    // crest rays gather. `out`: kWaves. A function of the time alone. No allocation.
    void at(Time time, std::span<glm::vec4> out) const;

    double shortestWave() const { return shortestWave_; }
    // The largest of these ways between surface and floor, as good as never exceeded.
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
