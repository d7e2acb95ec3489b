#include "drivers/site/body.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace fantascope::site {
namespace {

constexpr double kSkin = 1e-3;  // metres, so that a surface does not shadow itself

std::optional<double> ballMetBy(glm::dvec3 centre, double radius, glm::dvec3 origin, glm::dvec3 direction) {
    const glm::dvec3 offset = origin - centre;
    const double b = glm::dot(offset, direction), c = glm::dot(offset, offset) - radius * radius, root = b * b - c;
    if (root < 0 || -b - std::sqrt(root) <= 0) return std::nullopt;
    return -b - std::sqrt(root);
}

}  // namespace

// The cylinder between the ends first, then the ball at the end on whose side the ray passes it.
std::optional<double> Capsule::metBy(glm::dvec3 origin, glm::dvec3 direction) const {
    const glm::dvec3 axis = to - from, offset = origin - from;
    const double length2 = glm::dot(axis, axis), along = glm::dot(axis, direction), start = glm::dot(axis, offset);
    const double a = length2 - along * along;
    if (a < 1e-12) {  // a ball, or a ray along the axis
        const auto first = ballMetBy(from, radius, origin, direction), second = ballMetBy(to, radius, origin, direction);
        return first && second ? std::min(*first, *second) : first ? first : second;
    }
    const double b = length2 * glm::dot(offset, direction) - start * along;
    const double c = length2 * (glm::dot(offset, offset) - radius * radius) - start * start;
    const double root = b * b - a * c;
    if (root < 0) return std::nullopt;
    const double distance = (-b - std::sqrt(root)) / a, place = start + distance * along;
    if (place > 0 && place < length2) return distance > 0 ? std::optional(distance) : std::nullopt;
    return ballMetBy(place <= 0 ? from : to, radius, origin, direction);
}

double Capsule::shareAlong(glm::dvec3 point) const {
    const glm::dvec3 axis = to - from;
    const double length2 = glm::dot(axis, axis);
    return length2 > 0 ? std::clamp(glm::dot(point - from, axis) / length2, 0.0, 1.0) : 0;
}

glm::dvec3 Capsule::normalAt(glm::dvec3 point) const { return glm::normalize(point - glm::mix(from, to, shareAlong(point))); }

bool Capsule::contains(glm::dvec3 point) const { return glm::distance(point, glm::mix(from, to, shareAlong(point))) < radius; }

Body Body::standing(glm::dvec3 feet, glm::dvec3 direction, double height, glm::dvec3 reflectance) {
    // Left and right of the middle, up, all as shares of the height: a sketch of a grown person.
    const glm::dvec3 aside = glm::dvec3(-direction.z, 0, direction.x);
    const auto upright = [&](double side, double low, double high, double radius) {
        const glm::dvec3 axis = feet + aside * (side * height);
        return Capsule{axis + glm::dvec3(0, (low + radius) * height, 0), axis + glm::dvec3(0, (high - radius) * height, 0),
                       radius * height};
    };
    Body body;
    body.parts = {upright(-0.055, 0, 0.52, 0.05),   upright(0.055, 0, 0.52, 0.05),   upright(0, 0.44, 0.86, 0.1),
                  upright(-0.13, 0.38, 0.82, 0.03), upright(0.13, 0.38, 0.82, 0.03), upright(0, 0.86, 1, 0.07)};
    body.around = upright(0, -0.03, 1.03, 0.19);
    body.reflectance = reflectance;
    return body;
}

std::optional<Body::Hit> Body::metBy(glm::dvec3 origin, glm::dvec3 direction) const {
    if (!around.contains(origin) && !around.metBy(origin, direction)) return std::nullopt;
    std::optional<Hit> first;
    for (std::size_t i = 0; i < parts.size(); ++i)
        if (const auto distance = parts[i].metBy(origin, direction); distance && (!first || *distance < first->distance))
            first = Hit{*distance, i};
    return first;
}

bool Body::blocks(glm::dvec3 from, glm::dvec3 to) const {
    const double length = glm::distance(from, to);
    const glm::dvec3 direction = (to - from) / length;
    if (!around.contains(from) && !around.metBy(from, direction)) return false;
    return std::any_of(parts.begin(), parts.end(), [&](const Capsule& part) {
        const auto distance = part.metBy(from, direction);
        return distance && *distance < length - kSkin;
    });
}

}  // namespace fantascope::site
