#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <optional>

namespace fantascope::theatre {

// A screen that stands upright on the floor. Its frame: metres, +y up, the floor at y = 0, +z
// towards its light, +x to the right as seen from there. A flat screen is the plane z = 0. A curved
// one is the half of an upright cylinder that touches this plane along x = 0. The light on a curved
// screen is then a warp of the light that would fall on the plane, the *flat* screen. A place on
// the *unrolled* screen is its distance along the screen from x = 0 to the right, and its height.
// Thread: reentrant.
struct Screen {
    glm::dvec2 at{0};   // of the frame on the stage, (x, z)
    double turn = 0;    // of the frame about the upright, radians, right-handed
    double radius = 0;  // of the cylinder, metres; > 0: hollow towards the light; < 0: bulging towards it; 0: flat

    bool isCurved() const { return radius != 0; }
    glm::dvec3 screenFromStage(const glm::dvec3& point) const;
    glm::dvec3 stageFromScreen(const glm::dvec3& point) const;
    glm::dvec3 turnedFromStage(const glm::dvec3& direction) const;
    // The signed distance of a point of the stage to the screen, negative behind it; `outward`
    // becomes the unit direction in which it grows. Beyond the edges of the half cylinder a flat
    // wall continues to both sides.
    double distance(const glm::dvec3& point, glm::dvec3& outward) const;
    // The point of the screen, in its frame, at a place of the unrolled screen. The arc to the
    // place is at most kMostArc.
    glm::dvec3 surface(glm::dvec2 unrolled) const;

    static constexpr double kMostArc = 1.5;  // radians of the cylinder to either side

    friend bool operator==(const Screen&, const Screen&) = default;
};

// These map places between the flat and the unrolled screen along the light's rays. `light`: in the
// screen's frame, in front of the screen. If the screen is flat, they give the place itself.
// None: no light reaches the place, or only beyond kMostArc.
std::optional<glm::dvec2> flatFromUnrolled(const Screen& screen, const glm::dvec3& light, glm::dvec2 unrolled);
std::optional<glm::dvec2> unrolledFromFlat(const Screen& screen, const glm::dvec3& light, glm::dvec2 flat);

}  // namespace fantascope::theatre
