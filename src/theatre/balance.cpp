#include "theatre/balance.h"

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

}  // namespace

void findContacts(std::span<const PlacedSphere> spheres, Contacts& contacts) {
    contacts.discs.clear();
    double lowest = std::numeric_limits<double>::infinity();
    glm::dvec2 lowestPlace(0);
    for (const auto& [centre, radius] : spheres) {
        const double height = centre.y - radius;
        if (height < lowest) lowest = height, lowestPlace = {centre.x, centre.z};
        if (height > kTouch) continue;
        // The cap of the sphere below kTouch; of one that is pressed into the ground no more than its great circle.
        const double cap = std::min(kTouch - height, radius);
        contacts.discs.push_back({{centre.x, centre.z}, std::sqrt(cap * (2 * radius - cap))});
    }
    contacts.touches = !contacts.discs.empty();
    if (!contacts.touches) contacts.discs.push_back({lowestPlace, 0});
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
