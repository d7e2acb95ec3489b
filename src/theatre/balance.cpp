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

// Of the cap of a sphere that lies so deep below a plane; of one that is pressed into the ground no more than its great circle.
double capRadius(double radius, double depth) {
    const double cap = std::min(depth, radius);
    return std::sqrt(cap * (2 * radius - cap));
}

void finish(Contacts& contacts, double lowest, glm::dvec2 lowestPlace) {
    contacts.lowest = lowest;
    contacts.touches = !contacts.discs.empty();
    if (!contacts.touches) contacts.discs.push_back({lowestPlace, 0});
}

}  // namespace

void findContacts(std::span<const PlacedSphere> spheres, Contacts& contacts) {
    contacts.discs.clear();
    double lowest = std::numeric_limits<double>::infinity();
    glm::dvec2 lowestPlace(0);
    for (const auto& [centre, radius] : spheres) {
        const double height = centre.y - radius;
        if (height < lowest) lowest = height, lowestPlace = {centre.x, centre.z};
        if (height <= kTouch) contacts.discs.push_back({{centre.x, centre.z}, capRadius(radius, kTouch - height)});
    }
    finish(contacts, lowest, lowestPlace);
}

void findContacts(std::span<const glm::vec3> vertices, Contacts& contacts) {
    contacts.discs.clear();
    const glm::vec3* lowest = &vertices.front();
    // The vertex that reaches farthest in each direction; of those alike the first.
    std::array<const glm::vec3*, kDirections> best{};
    std::array<double, kDirections> far;
    far.fill(std::numeric_limits<double>::lowest());
    for (const glm::vec3& vertex : vertices) {
        if (vertex.y < lowest->y) lowest = &vertex;
        if (vertex.y > kTouch) continue;
        const glm::dvec2 place(vertex.x, vertex.z);
        for (std::size_t i = 0; i < kDirections; ++i)
            if (const double reach = glm::dot(place, directions()[i]); reach > far[i]) far[i] = reach, best[i] = &vertex;
    }
    // Around the polygon equal ones follow each other.
    for (std::size_t i = 0; i < kDirections; ++i)
        if (best[i] != nullptr && best[i] != best[(i + 1) % kDirections]) contacts.discs.push_back({{best[i]->x, best[i]->z}, 0});
    // One vertex that is farthest in all directions.
    if (contacts.discs.empty() && best[0] != nullptr) contacts.discs.push_back({{best[0]->x, best[0]->z}, 0});
    finish(contacts, lowest->y, {lowest->x, lowest->z});
}

void findBearings(std::span<const PlacedSphere> spheres, double bearing, Contacts& contacts) {
    contacts.discs.clear();
    const auto heightOf = [](const PlacedSphere& sphere) { return sphere.centre.y - sphere.radius; };
    const auto lowest = std::min_element(spheres.begin(), spheres.end(),
                                         [&](const PlacedSphere& a, const PlacedSphere& b) { return heightOf(a) < heightOf(b); });
    const glm::dvec2 lowestPlace(lowest->centre.x, lowest->centre.z);
    const double ground = heightOf(*lowest);
    contacts.touches = ground <= kTouch;
    for (const PlacedSphere& sphere : spheres) {
        const double share = std::min(1.0, 1 - (heightOf(sphere) - ground - kTouch / 2) / bearing);
        if (share > 0)
            contacts.discs.push_back({glm::mix(lowestPlace, glm::dvec2(sphere.centre.x, sphere.centre.z), share),
                                      share * capRadius(sphere.radius, kTouch)});
    }
}

double supportMargin(const Contacts& contacts, const glm::dvec3& massCentre) {
    const glm::dvec2 centre(massCentre.x, massCentre.z);
    double margin = std::numeric_limits<double>::max();
    // The least of the distances to the hull's tangents; outside it is minus the distance to the hull.
    for (const glm::dvec2& direction : directions())
        margin = std::min(margin, farthest(contacts, direction).second - glm::dot(centre, direction));
    return margin;
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
