#pragma once

#include <glm/vec3.hpp>

#include <array>
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

}  // namespace fantascope::plot
