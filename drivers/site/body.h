#pragma once

#include <glm/vec3.hpp>

#include <array>
#include <optional>

namespace fantascope::site {

// All points that are at most `radius` from the line between two points: an arm, a leg. Both ends
// in the same place make a ball.
struct Capsule {
    glm::dvec3 from{0.0}, to{0.0};  // metres
    double radius = 0;              // metres

    // The distance to the first point of its surface along a ray that begins outside of it.
    // `direction` is unit.
    std::optional<double> metBy(glm::dvec3 origin, glm::dvec3 direction) const;
    // How far from `from` to `to` the place on the line is that a point is nearest to, 0..1.
    double shareAlong(glm::dvec3 point) const;
    glm::dvec3 normalAt(glm::dvec3 point) const;  // of its surface, unit, outwards
    bool contains(glm::dvec3 point) const;
};

// A person who stands upright: legs, trunk, arms and head, in matt clothes.
struct Body {
    static constexpr std::size_t kParts = 6;
    std::array<Capsule, kParts> parts;
    Capsule around;  // holds all parts
    glm::dvec3 reflectance{0.3};

    // Feet on the ground at `feet`, face towards the unit `direction`; `height`: metres.
    static Body standing(glm::dvec3 feet, glm::dvec3 direction, double height, glm::dvec3 reflectance);

    struct Hit {
        double distance = 0;  // metres
        std::size_t part = 0;
    };
    // The first part along the ray.
    std::optional<Hit> metBy(glm::dvec3 origin, glm::dvec3 direction) const;
    // Whether it keeps light from going between two points.
    bool blocks(glm::dvec3 from, glm::dvec3 to) const;
};

}  // namespace fantascope::site
