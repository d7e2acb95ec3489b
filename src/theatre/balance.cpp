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

const glm::vec3& lowestOf(std::span<const glm::vec3> vertices) {
    return *std::min_element(vertices.begin(), vertices.end(), [](const glm::vec3& a, const glm::vec3& b) { return a.y < b.y; });
}

// Of many points those that reach farthest in a direction; of those alike the first.
class Corners {
public:
    Corners() { far_.fill(std::numeric_limits<double>::lowest()); }
    void offer(glm::dvec2 place) {
        for (std::size_t i = 0; i < kDirections; ++i)
            if (const double reach = glm::dot(place, directions()[i]); reach > far_[i]) far_[i] = reach, places_[i] = place;
    }
    // As contacts of no radius; around the polygon equal ones follow each other.
    void addTo(Contacts& contacts) const {
        if (far_[0] == std::numeric_limits<double>::lowest()) return;
        const std::size_t first = contacts.discs.size();
        for (std::size_t i = 0; i < kDirections; ++i)
            if (places_[i] != places_[(i + 1) % kDirections]) contacts.discs.push_back({places_[i], 0});
        if (contacts.discs.size() == first) contacts.discs.push_back({places_[0], 0});
    }

private:
    std::array<double, kDirections> far_;
    std::array<glm::dvec2, kDirections> places_{};
};

// How much of its own place and size a point so high above the ground has: findBearings().
double bearingShare(double height, double bearing) { return std::min(1.0, 1 - (height - kTouch / 2) / bearing); }

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
    const glm::vec3& lowest = lowestOf(vertices);
    Corners corners;
    for (const glm::vec3& vertex : vertices)
        if (vertex.y <= kTouch) corners.offer({vertex.x, vertex.z});
    corners.addTo(contacts);
    finish(contacts, lowest.y, {lowest.x, lowest.z});
}

void findBearings(std::span<const PlacedSphere> spheres, double bearing, Contacts& contacts) {
    contacts.discs.clear();
    const auto heightOf = [](const PlacedSphere& sphere) { return sphere.centre.y - sphere.radius; };
    const auto lowest = std::min_element(spheres.begin(), spheres.end(),
                                         [&](const PlacedSphere& a, const PlacedSphere& b) { return heightOf(a) < heightOf(b); });
    const glm::dvec2 lowestPlace(lowest->centre.x, lowest->centre.z);
    const double ground = contacts.lowest = heightOf(*lowest);
    contacts.touches = ground <= kTouch;
    for (const PlacedSphere& sphere : spheres) {
        const double share = bearingShare(heightOf(sphere) - ground, bearing);
        if (share > 0)
            contacts.discs.push_back({glm::mix(lowestPlace, glm::dvec2(sphere.centre.x, sphere.centre.z), share),
                                      share * capRadius(sphere.radius, kTouch)});
    }
}

void findBearings(std::span<const glm::vec3> vertices, double bearing, Contacts& contacts) {
    contacts.discs.clear();
    const glm::vec3& lowest = lowestOf(vertices);
    const glm::dvec2 lowestPlace(lowest.x, lowest.z);
    contacts.lowest = lowest.y;
    contacts.touches = lowest.y <= kTouch;
    Corners corners;
    for (const glm::vec3& vertex : vertices)
        if (const double share = bearingShare(vertex.y - lowest.y, bearing); share > 0)
            corners.offer(glm::mix(lowestPlace, glm::dvec2(vertex.x, vertex.z), share));
    corners.addTo(contacts);
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
