#pragma once

#include "media/image.h"

#include <glm/common.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cmath>
#include <cstddef>

namespace fantascope::plot {

// An actor's colour in all pictures, and an output's in the figure of a night; sRGB 0..1. Colours
// repeat after the eighth. After Okabe & Ito 2008, whose colours colour-blind people can
// distinguish; brown replaces black, which is used for shadow and outline.
inline glm::dvec3 actorColour(std::size_t actor) {
    constexpr std::array<std::array<int, 3>, 8> kColours{{{230, 159, 0},
                                                          {86, 180, 233},
                                                          {0, 158, 115},
                                                          {204, 121, 167},
                                                          {0, 114, 178},
                                                          {240, 228, 66},
                                                          {213, 94, 0},
                                                          {118, 84, 60}}};
    const auto& [r, g, b] = kColours[actor % kColours.size()];
    return glm::dvec3(r, g, b) / 255.0;
}

// A colour scale from red through white to blue, dark at both ends; sRGB. -1 <= difference <= 1.
inline glm::dvec3 diverging(double difference) {
    constexpr std::array<glm::dvec3, 3> kBelow{{{1, 1, 1}, {0.94, 0.42, 0.32}, {0.55, 0, 0.12}}},
        kAbove{{{1, 1, 1}, {0.35, 0.6, 0.87}, {0.03, 0.19, 0.5}}};
    const auto& colours = difference < 0 ? kBelow : kAbove;
    const double at = 2 * std::abs(difference);
    return at < 1 ? glm::mix(colours[0], colours[1], at) : glm::mix(colours[1], colours[2], at - 1);
}

// A colour as a picture stores it.
inline Rgba8 stored(glm::dvec3 colour) {
    const auto byte = [](double value) { return static_cast<std::uint8_t>(std::lround(255 * value)); };
    return {byte(colour.r), byte(colour.g), byte(colour.b), 255};
}

}  // namespace fantascope::plot
