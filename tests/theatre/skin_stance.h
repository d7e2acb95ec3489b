#pragma once

#include "theatre/body/body_mesh.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace fantascope::theatre {

// How a skin stands, by its mesh alone: what anybody would measure who has only the mesh. Nothing
// here is the program's.

// The centre of what a closed mesh encloses, as if it were all alike: the sum over the tetrahedra
// between its triangles and one point.
inline glm::dvec3 centreOfVolume(const std::vector<glm::vec3>& vertices, const std::vector<glm::uvec3>& triangles) {
    const glm::dvec3 origin(vertices[0]);
    double volume = 0;
    glm::dvec3 moment(0);
    for (const glm::uvec3& t : triangles) {
        const glm::dvec3 a = glm::dvec3(vertices[t[0]]) - origin, b = glm::dvec3(vertices[t[1]]) - origin,
                         c = glm::dvec3(vertices[t[2]]) - origin;
        const double six = glm::dot(a, glm::cross(b, c));
        volume += six;
        moment += six * (a + b + c) / 4.0;
    }
    return origin + moment / volume;
}

// The signed distance, seen from above, from that centre to the boundary of the hull of the
// vertices that are no more than 2 cm above the lowest one; metres, positive inside.
inline double marginOfMesh(const std::vector<glm::vec3>& vertices, const std::vector<glm::uvec3>& triangles) {
    constexpr float kBears = 0.02f;
    float lowest = std::numeric_limits<float>::max();
    for (const glm::vec3& vertex : vertices) lowest = std::min(lowest, vertex.y);
    std::vector<glm::dvec2> points;
    for (const glm::vec3& vertex : vertices)
        if (vertex.y <= lowest + kBears) points.emplace_back(vertex.x, vertex.z);
    const glm::dvec3 massCentre = centreOfVolume(vertices, triangles);
    const glm::dvec2 centre(massCentre.x, massCentre.z);
    const auto cross = [](const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; };

    // Around the hull from its leftmost point: the next is that which has all others on its left.
    glm::dvec2 first = points[0];
    for (const glm::dvec2& p : points)
        if (p.x < first.x || (p.x == first.x && p.y < first.y)) first = p;
    double nearest = std::numeric_limits<double>::infinity();
    bool isInside = true;
    glm::dvec2 here = first;
    for (std::size_t i = 0; i <= points.size(); ++i) {
        glm::dvec2 next = here;
        for (const glm::dvec2& p : points) {
            const double side = cross(next - here, p - here);
            if (p != here && (next == here || side < 0 || (side == 0 && glm::distance(p, here) > glm::distance(next, here))))
                next = p;
        }
        const glm::dvec2 along = next - here, away = centre - here;
        const double share =
            glm::dot(along, along) > 0 ? std::clamp(glm::dot(away, along) / glm::dot(along, along), 0.0, 1.0) : 0;
        nearest = std::min(nearest, glm::length(away - share * along));
        isInside = isInside && cross(along, away) > 0;
        here = next;
        if (here == first) break;
    }
    return isInside ? nearest : -nearest;
}

}  // namespace fantascope::theatre
