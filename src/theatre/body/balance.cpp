#include "theatre/body/balance.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace fantascope::theatre {
namespace {

// The radius of the circle in which a plane cuts a sphere that reaches `depth` below it; at most
// the great circle, for a sphere pressed deeper.
double capRadius(double radius, double depth) {
    const double cap = std::min(depth, radius);
    return std::sqrt(cap * (2 * radius - cap));
}

double heightOf(const PlacedSphere& sphere) { return sphere.centre.y - sphere.radius; }
double heightOf(const glm::vec3& vertex) { return vertex.y; }
glm::dvec2 groundPlace(const PlacedSphere& sphere) { return {sphere.centre.x, sphere.centre.z}; }
glm::dvec2 groundPlace(const glm::vec3& vertex) { return {vertex.x, vertex.z}; }

template <class Point>
glm::dvec2 begin(std::span<const Point> points, Contacts& contacts) {
    contacts.discs.clear();
    const auto lowest =
        std::min_element(points.begin(), points.end(), [](const Point& a, const Point& b) { return heightOf(a) < heightOf(b); });
    contacts.lowest = heightOf(*lowest);
    contacts.lowestSource = static_cast<std::uint32_t>(lowest - points.begin());
    contacts.touches = contacts.lowest <= kTouch;
    return groundPlace(*lowest);
}

// Visits the points where the edges of a skin cross a height.
void cut(std::span<const glm::vec3> vertices, std::span<const MeshEdge> edges, double height, std::vector<Contact>& discs) {
    for (const MeshEdge& edge : edges) {
        const float from = vertices[edge.from].y, to = vertices[edge.to].y;
        if ((from <= height) == (to <= height)) continue;
        const glm::dvec3 a(vertices[edge.from]), b(vertices[edge.to]);
        const glm::dvec3 point = glm::mix(a, b, (height - a.y) / (b.y - a.y));
        discs.push_back({{point.x, point.z}, 0, from < to ? edge.from : edge.to, 1, point, b - a});
    }
}

// The share that a point at this height above the ground bears: findBearings().
double bearingShare(double height, double bearing) { return std::min(1.0, 1 - (height - kTouch / 2) / bearing); }

}  // namespace

void findContacts(std::span<const PlacedSphere> spheres, Contacts& contacts) {
    const glm::dvec2 lowestPlace = begin(spheres, contacts);
    for (std::uint32_t i = 0; i < spheres.size(); ++i)
        if (const double height = heightOf(spheres[i]); height <= kTouch)
            contacts.discs.push_back(
                {groundPlace(spheres[i]), capRadius(spheres[i].radius, kTouch - height), i, 1, spheres[i].centre});
    if (!contacts.touches) contacts.discs.push_back({lowestPlace});
    contacts.support.build(contacts.discs);
}

void findContacts(std::span<const glm::vec3> vertices, std::span<const MeshEdge> edges, Contacts& contacts) {
    const glm::dvec2 lowestPlace = begin(vertices, contacts);
    for (std::uint32_t i = 0; i < vertices.size(); ++i)
        if (vertices[i].y <= kTouch) contacts.discs.push_back({groundPlace(vertices[i]), 0, i, 1, vertices[i]});
    cut(vertices, edges, kTouch, contacts.discs);
    if (!contacts.touches) contacts.discs.push_back({lowestPlace});
    contacts.support.buildAndPrune(contacts.discs);
}

void findBearings(std::span<const PlacedSphere> spheres, double bearing, Contacts& contacts) {
    const glm::dvec2 lowestPlace = begin(spheres, contacts);
    for (std::uint32_t i = 0; i < spheres.size(); ++i)
        if (const double share = bearingShare(heightOf(spheres[i]) - contacts.lowest, bearing); share > 0)
            contacts.discs.push_back({glm::mix(lowestPlace, groundPlace(spheres[i]), share),
                                      share * capRadius(spheres[i].radius, kTouch), i, share, spheres[i].centre});
    contacts.support.build(contacts.discs);
}

void findBearings(std::span<const glm::vec3> vertices, std::span<const MeshEdge> edges, double bearing, Contacts& contacts) {
    const glm::dvec2 lowestPlace = begin(vertices, contacts);
    for (std::uint32_t i = 0; i < vertices.size(); ++i)
        if (const double share = bearingShare(vertices[i].y - contacts.lowest, bearing); share > 0)
            contacts.discs.push_back({glm::mix(lowestPlace, groundPlace(vertices[i]), share), 0, i, share, vertices[i]});
    cut(vertices, edges, contacts.lowest + kTouch / 2, contacts.discs);
    contacts.support.buildAndPrune(contacts.discs);
}

}  // namespace fantascope::theatre
