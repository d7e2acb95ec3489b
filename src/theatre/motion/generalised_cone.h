#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <cstddef>
#include <span>
#include <vector>

namespace fantascope::theatre {

// The light and a target whose interior is triangulated: a tetrahedron for each triangle, the light
// its apex (Won & Lee 2016, section 5, figure 7). What stands in one tetrahedron of a frame's cone
// has a place in the same tetrahedron of another's. Metres, stage frame.
// Thread: reentrant.
class GeneralisedCone {
public:
    // `corners`: of the triangles, (x, y) on the screen, which is z = 0. At least one triangle.
    GeneralisedCone(const glm::dvec3& light, std::span<const glm::uvec3> triangles, std::span<const glm::dvec2> corners);

    // Barycentric coordinates: of the light and of the corners of a tetrahedron's triangle. They
    // add up to 1, and none is negative.
    struct Coordinates {
        std::size_t tetrahedron = 0;
        glm::dvec4 weights{0};
        // A point whose shadow falls beside all triangles has the coordinates of where the nearest
        // one is nearest, and the rest of the way on the screen, along that triangle's first edge
        // and across it: negative coordinates would carry it off as that triangle shears.
        glm::dvec2 beside{0};
    };
    // `point`: nearer to the screen than the light is.
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
