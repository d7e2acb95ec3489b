#include "theatre/balance.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace fantascope::theatre {
namespace {

// Directions in which the hull is felt: it is known to 1 - cos(pi / 48), .2 % of its size.
constexpr std::size_t kDirections = 48;

const std::array<glm::dvec2, kDirections>& directions() {
    static const auto table = [] {
        std::array<glm::dvec2, kDirections> directions;
        for (std::size_t i = 0; i < kDirections; ++i) {
            const double angle = 2 * std::numbers::pi * static_cast<double>(i) / kDirections;
            directions[i] = {std::cos(angle), std::sin(angle)};
        }
        return directions;
    }();
    return table;
}

// The disc that reaches farthest in a direction, and how far.
std::pair<const Contact*, double> farthest(const Contacts& contacts, glm::dvec2 direction) {
    const Contact* best = nullptr;
    double far = std::numeric_limits<double>::lowest();
    for (const Contact& contact : contacts.discs)
        if (const double reach = glm::dot(contact.place, direction) + contact.radius; reach > far) far = reach, best = &contact;
    return {best, far};
}

SupportTangent tangentTowards(const Contacts& contacts, const glm::dvec3& massCentre, std::size_t direction) {
    const glm::dvec2 outward = directions()[direction];
    const auto [contact, far] = farthest(contacts, outward);
    return {far - glm::dot(glm::dvec2(massCentre.x, massCentre.z), outward), outward, contact};
}

// Of the cap of a sphere that lies so deep below a plane; of one that is pressed into the ground no more than its great circle.
double capRadius(double radius, double depth) {
    const double cap = std::min(depth, radius);
    return std::sqrt(cap * (2 * radius - cap));
}

double heightOf(const PlacedSphere& sphere) { return sphere.centre.y - sphere.radius; }
double heightOf(const glm::vec3& vertex) { return vertex.y; }
glm::dvec2 groundPlace(const PlacedSphere& sphere) { return {sphere.centre.x, sphere.centre.z}; }
glm::dvec2 groundPlace(const glm::vec3& vertex) { return {vertex.x, vertex.z}; }

// Of many points those that reach farthest in a direction; of those alike the first.
class Corners {
public:
    Corners() { far_.fill(std::numeric_limits<double>::lowest()); }
    void offer(const Contact& contact) {
        for (std::size_t i = 0; i < kDirections; ++i)
            if (const double reach = glm::dot(contact.place, directions()[i]); reach > far_[i])
                far_[i] = reach, contacts_[i] = contact;
    }
    // Around the polygon equal ones follow each other.
    void addTo(Contacts& contacts) const {
        if (far_[0] == std::numeric_limits<double>::lowest()) return;
        const std::size_t first = contacts.discs.size();
        for (std::size_t i = 0; i < kDirections; ++i)
            if (contacts_[i].place != contacts_[(i + 1) % kDirections].place) contacts.discs.push_back(contacts_[i]);
        if (contacts.discs.size() == first) contacts.discs.push_back(contacts_[0]);
    }

private:
    std::array<double, kDirections> far_;
    std::array<Contact, kDirections> contacts_{};
};

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

// Where the edges of a skin go through a height.
void cut(std::span<const glm::vec3> vertices, std::span<const MeshEdge> edges, double height, Corners& corners) {
    for (const MeshEdge& edge : edges) {
        const float from = vertices[edge.from].y, to = vertices[edge.to].y;
        if ((from <= height) == (to <= height)) continue;
        const glm::dvec3 a(vertices[edge.from]), b(vertices[edge.to]);
        const glm::dvec3 point = glm::mix(a, b, (height - a.y) / (b.y - a.y));
        corners.offer({{point.x, point.z}, 0, from < to ? edge.from : edge.to, 1, point, b - a});
    }
}

// How much of its own place and size a point so high above the ground has: findBearings().
double bearingShare(double height, double bearing) { return std::min(1.0, 1 - (height - kTouch / 2) / bearing); }

}  // namespace

void findContacts(std::span<const PlacedSphere> spheres, Contacts& contacts) {
    const glm::dvec2 lowestPlace = begin(spheres, contacts);
    for (std::uint32_t i = 0; i < spheres.size(); ++i)
        if (const double height = heightOf(spheres[i]); height <= kTouch)
            contacts.discs.push_back(
                {groundPlace(spheres[i]), capRadius(spheres[i].radius, kTouch - height), i, 1, spheres[i].centre});
    if (!contacts.touches) contacts.discs.push_back({lowestPlace});
}

void findContacts(std::span<const glm::vec3> vertices, std::span<const MeshEdge> edges, Contacts& contacts) {
    const glm::dvec2 lowestPlace = begin(vertices, contacts);
    Corners corners;
    for (std::uint32_t i = 0; i < vertices.size(); ++i)
        if (vertices[i].y <= kTouch) corners.offer({groundPlace(vertices[i]), 0, i, 1, vertices[i]});
    cut(vertices, edges, kTouch, corners);
    corners.addTo(contacts);
    if (!contacts.touches) contacts.discs.push_back({lowestPlace});
}

void findBearings(std::span<const PlacedSphere> spheres, double bearing, Contacts& contacts) {
    const glm::dvec2 lowestPlace = begin(spheres, contacts);
    for (std::uint32_t i = 0; i < spheres.size(); ++i)
        if (const double share = bearingShare(heightOf(spheres[i]) - contacts.lowest, bearing); share > 0)
            contacts.discs.push_back({glm::mix(lowestPlace, groundPlace(spheres[i]), share),
                                      share * capRadius(spheres[i].radius, kTouch), i, share, spheres[i].centre});
}

void findBearings(std::span<const glm::vec3> vertices, std::span<const MeshEdge> edges, double bearing, Contacts& contacts) {
    const glm::dvec2 lowestPlace = begin(vertices, contacts);
    Corners corners;
    for (std::uint32_t i = 0; i < vertices.size(); ++i)
        if (const double share = bearingShare(vertices[i].y - contacts.lowest, bearing); share > 0)
            corners.offer({glm::mix(lowestPlace, groundPlace(vertices[i]), share), 0, i, share, vertices[i]});
    cut(vertices, edges, contacts.lowest + kTouch / 2, corners);
    corners.addTo(contacts);
}

double supportMargin(const Contacts& contacts, const glm::dvec3& massCentre) {
    return supportTangent(contacts, massCentre).margin;
}

// The least of the distances to the hull's tangents; outside it is minus the distance to the hull.
SupportTangent supportTangent(const Contacts& contacts, const glm::dvec3& massCentre) {
    SupportTangent nearest = tangentTowards(contacts, massCentre, 0);
    for (std::size_t i = 1; i < kDirections; ++i)
        if (const SupportTangent tangent = tangentTowards(contacts, massCentre, i); tangent.margin < nearest.margin)
            nearest = tangent;
    return nearest;
}

void findSupportTangents(const Contacts& contacts, const glm::dvec3& massCentre, double beyond,
                         std::vector<SupportTangent>& tangents) {
    std::array<SupportTangent, kDirections> all;
    double least = std::numeric_limits<double>::max();
    for (std::size_t i = 0; i < kDirections; ++i) {
        all[i] = tangentTowards(contacts, massCentre, i);
        least = std::min(least, all[i].margin);
    }
    tangents.clear();
    for (std::size_t i = 0; i < kDirections; ++i) {
        const double before = all[(i + kDirections - 1) % kDirections].margin, after = all[(i + 1) % kDirections].margin;
        if (all[i].margin <= least + beyond && all[i].margin < before && all[i].margin <= after) tangents.push_back(all[i]);
    }
    // A disc around its middle is as wide everywhere.
    if (tangents.empty()) tangents.push_back(supportTangent(contacts, massCentre));
}

double supportArea(const Contacts& contacts) {
    double area = 0;
    std::array<glm::dvec2, kDirections> hull;
    for (std::size_t i = 0; i < kDirections; ++i) {
        const Contact* contact = farthest(contacts, directions()[i]).first;
        hull[i] = contact->place + contact->radius * directions()[i];
    }
    for (std::size_t i = 0; i < kDirections; ++i) {
        const glm::dvec2 a = hull[i], b = hull[(i + 1) % kDirections];
        area += 0.5 * (a.x * b.y - a.y * b.x);
    }
    return area;
}

}  // namespace fantascope::theatre
