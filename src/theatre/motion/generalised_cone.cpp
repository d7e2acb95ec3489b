#include "theatre/motion/generalised_cone.h"

#include "core/check.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <limits>

namespace fantascope::theatre {
namespace {

double cross(glm::dvec2 a, glm::dvec2 b) { return a.x * b.y - a.y * b.x; }

// The barycentric coordinates of the point of a triangle that is nearest to a given one (Ericson
// 2005, section 5.1.5).
glm::dvec3 nearestIn(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c, glm::dvec2 point) {
    const double area = cross(b - a, c - a);
    if (area != 0) {
        const glm::dvec3 inside(cross(b - point, c - point) / area, cross(c - point, a - point) / area,
                                cross(a - point, b - point) / area);
        if (std::min({inside.x, inside.y, inside.z}) >= 0) return inside;
    }
    const glm::dvec2 corners[] = {a, b, c};
    glm::dvec3 best(1, 0, 0);
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 3; ++i) {
        const glm::dvec2 from = corners[i], edge = corners[(i + 1) % 3] - from;
        const double square = glm::dot(edge, edge);
        const double t = square > 0 ? std::clamp(glm::dot(point - from, edge) / square, 0.0, 1.0) : 0;
        const double distance = glm::distance(point, from + t * edge);
        if (distance >= least) continue;
        least = distance;
        best = glm::dvec3(0);
        best[i] = 1 - t;
        best[(i + 1) % 3] = t;
    }
    return best;
}

}  // namespace

GeneralisedCone::GeneralisedCone(const glm::dvec3& light, std::span<const glm::uvec3> triangles,
                                 std::span<const glm::dvec2> corners)
    : light_(light) {
    FANTASCOPE_CHECK(!triangles.empty() && light.z > 0, "a cone has a light in front of the screen, and a triangle");
    for (const glm::uvec3& corner : triangles) {
        Triangle triangle{corners[corner.x], corners[corner.y], corners[corner.z]};
        const glm::dvec2 edge = triangle.b - triangle.a;
        if (const double length = glm::length(edge); length > 0) triangle.along = edge / length;
        triangles_.push_back(triangle);
    }
}

GeneralisedCone::Coordinates GeneralisedCone::coordinates(const glm::dvec3& point) const {
    const double share = (light_.z - point.z) / light_.z;  // of the way from the light to the screen
    FANTASCOPE_CHECK(share > 0, "only what is nearer to the screen than the light throws a shadow there");
    const glm::dvec2 shadow = glm::dvec2(light_) + (glm::dvec2(point) - glm::dvec2(light_)) / share;
    Coordinates found;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < triangles_.size() && least > 0; ++i) {
        const auto& [a, b, c, along] = triangles_[i];
        const glm::dvec3 in = nearestIn(a, b, c, shadow);
        const glm::dvec2 off = shadow - (in.x * a + in.y * b + in.z * c);
        const double distance = std::min({in.x, in.y, in.z}) > 0 ? 0 : glm::length(off);
        if (distance >= least) continue;
        least = distance;
        found = {i, glm::dvec4(1 - share, share * in.x, share * in.y, share * in.z), {glm::dot(off, along), cross(along, off)}};
    }
    return found;
}

glm::dvec3 GeneralisedCone::point(const Coordinates& coordinates) const {
    const auto& [a, b, c, along] = triangles_[coordinates.tetrahedron];
    const glm::dvec4& w = coordinates.weights;
    const glm::dvec2 beside = coordinates.beside.x * along + coordinates.beside.y * glm::dvec2(-along.y, along.x);
    const glm::dvec2 onScreen = w.y * a + w.z * b + w.w * c + (1 - w.x) * beside;
    return w.x * light_ + glm::dvec3(onScreen, 0);
}

}  // namespace fantascope::theatre
