#pragma once

#include <glm/vec2.hpp>

namespace fantascope {

// The wind of one moment, as set by the show and obeyed by the shapes. It scales a pattern's own
// movement; the default changes nothing.
struct Wind {
    double strength = 1;  // >= 0; factor of every displacement and its range
    // The groups' major movement goes along ownDirection * (the pattern's own direction) +
    // direction. That is a unit vector, or a shorter one while the wind turns.
    double ownDirection = 1;    // 0..1
    glm::dvec2 direction{0.0};  // in the canvas, y down; |direction| <= 1 - ownDirection

    friend bool operator==(const Wind&, const Wind&) = default;
};

}  // namespace fantascope
