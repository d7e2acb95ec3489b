#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <optional>

namespace fantascope::theatre {

// A screen that stands upright on the floor. Its frame: metres, +y up, the floor at y = 0, +z
// towards its light, +x to the right as seen from there. It is the plane z = 0, or, curved, the
// half of an upright cylinder that touches this plane along x = 0. What light throws on a curved
// screen is then a warp of what it would throw on the plane: on the *flat* screen. A place on the
// *unrolled* screen is how far along the screen it is from x = 0 to the right, and up. Thread:
// reentrant.
struct Screen {
    glm::dvec2 at{0};   // of the frame on the stage, (x, z)
    double turn = 0;    // of the frame about the upright, radians, right-handed
    double radius = 0;  // of the cylinder: > 0: hollow towards the light; < 0: bulging towards it; 0: flat

    bool isCurved() const { return radius != 0; }
    glm::dvec3 screenFromStage(const glm::dvec3& point) const;
    glm::dvec3 stageFromScreen(const glm::dvec3& point) const;
    glm::dvec3 turnedFromStage(const glm::dvec3& direction) const;
    // How far a point of the stage is before the screen, negative behind it, and the unit direction
    // in which that grows. What a cylinder's half ends at goes on to both sides as a wall.
    double distance(const glm::dvec3& point, glm::dvec3& outward) const;
    // A place of the unrolled screen, no farther than kMostArc along it, in the screen's frame.
    glm::dvec3 surface(glm::dvec2 unrolled) const;

    static constexpr double kMostArc = 1.5;  // radians of the cylinder to either side

    friend bool operator==(const Screen&, const Screen&) = default;
};

// Where the light's ray through one of them meets the other; `light`: in the screen's frame, before
// the screen. On a flat screen a place is itself.
// None: the light does not come there, or not before kMostArc.
std::optional<glm::dvec2> flatFromUnrolled(const Screen& screen, const glm::dvec3& light, glm::dvec2 unrolled);
std::optional<glm::dvec2> unrolledFromFlat(const Screen& screen, const glm::dvec3& light, glm::dvec2 flat);

}  // namespace fantascope::theatre
