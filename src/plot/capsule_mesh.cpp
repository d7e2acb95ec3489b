#include "plot/capsule_mesh.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fantascope::plot {
namespace {

constexpr unsigned kAround = 20, kCap = 6;  // points of a ring; rings of a round end

// A surface of revolution: rings on the first sphere as far as the tangent cone, then on the second.
void add(const theatre::PlacedCapsule& capsule, TriangleMesh& mesh) {
    const glm::dvec3 between = capsule.to - capsule.from;
    const double length = glm::length(between);
    const glm::dvec3 axis = length > 0 ? between / length : glm::dvec3(0, 1, 0);
    const glm::dvec3 side = glm::normalize(glm::cross(axis, std::abs(axis.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0)));
    const glm::dvec3 other = glm::cross(axis, side);
    // The angle from the axis at which the cone touches both; none of the smaller sphere if it lies in the larger.
    const double taper = capsule.fromRadius - capsule.toRadius;
    const double touch = length > std::abs(taper) ? std::acos(taper / length) : taper > 0 ? 0 : std::numbers::pi;
    const auto first = static_cast<unsigned>(mesh.vertices.size());
    unsigned rings = 0;
    const auto addRing = [&](const glm::dvec3& centre, double radius, double angle) {
        for (unsigned i = 0; i < kAround; ++i) {
            const double turn = 2 * std::numbers::pi * i / kAround;
            mesh.vertices.emplace_back(
                centre + radius * (std::cos(angle) * axis + std::sin(angle) * (std::cos(turn) * side + std::sin(turn) * other)));
        }
        ++rings;
    };
    for (unsigned i = 1; i <= kCap; ++i)
        addRing(capsule.from, capsule.fromRadius, glm::mix(std::numbers::pi, touch, double(i) / kCap));
    for (unsigned i = 0; i < kCap; ++i) addRing(capsule.to, capsule.toRadius, glm::mix(touch, 0.0, double(i) / kCap));
    const unsigned start = first + rings * kAround, end = start + 1;
    mesh.vertices.emplace_back(capsule.from - capsule.fromRadius * axis);
    mesh.vertices.emplace_back(capsule.to + capsule.toRadius * axis);
    for (unsigned i = 0; i < kAround; ++i) {
        const unsigned next = (i + 1) % kAround;
        mesh.triangles.push_back({start, first + next, first + i});
        for (unsigned ring = 0; ring + 1 < rings; ++ring) {
            const unsigned below = first + ring * kAround, above = below + kAround;
            mesh.triangles.push_back({below + i, below + next, above + next});
            mesh.triangles.push_back({below + i, above + next, above + i});
        }
        const unsigned last = first + (rings - 1) * kAround;
        mesh.triangles.push_back({last + i, last + next, end});
    }
}

}  // namespace

TriangleMesh capsuleMesh(std::span<const theatre::PlacedCapsule> capsules) {
    TriangleMesh mesh;
    for (const theatre::PlacedCapsule& capsule : capsules) add(capsule, mesh);
    return mesh;
}

}  // namespace fantascope::plot
