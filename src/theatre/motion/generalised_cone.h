#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <cstddef>
#include <span>
#include <vector>

namespace fantascope::theatre {

// The generalised cone of the light over a triangulated target: a tetrahedron for each triangle,
// with its apex at the light (Won & Lee 2016, section 5, figure 7). A point in a tetrahedron of one
// frame's cone has a corresponding place in the same tetrahedron of another frame's. Metres, stage
// frame.
// Thread: reentrant.
class GeneralisedCone {
public:
    // `corners`: of the triangles, (x, y) on the screen, z = 0, metres. There must be at least one
    // triangle.
    GeneralisedCone(const glm::dvec3& light, std::span<const glm::uvec3> triangles, std::span<const glm::dvec2> corners);

    // Barycentric coordinates in a tetrahedron: first the light's, then those of the triangle's
    // corners. They add up to 1, and none is negative.
    struct Coordinates {
        std::size_t tetrahedron = 0;
        glm::dvec4 weights{0};
        // If the shadow of a point falls outside all triangles, the coordinates are those of the
        // nearest point of the nearest triangle. `beside` is the remaining offset on the screen,
        // metres, along that triangle's first edge and across it. Negative coordinates would
        // instead amplify the shear of the triangle.
        glm::dvec2 beside{0};
    };
    // `point` must be nearer to the screen than the light is.
    Coordinates coordinates(const glm::dvec3& point) const;
    glm::dvec3 point(const Coordinates& coordinates) const;

private:
    struct Triangle {
        glm::dvec2 a{0}, b{0}, c{0};
        glm::dvec2 along{1, 0};  // unit, of the edge from a to b
    };
    glm::dvec3 light_;
    std::vector<Triangle> triangles_;
};

}  // namespace fantascope::theatre
