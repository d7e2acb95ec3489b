#include "theatre/stage/screen.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace fantascope::theatre {

glm::dvec3 Screen::turnedFromStage(const glm::dvec3& direction) const {
    const double c = std::cos(turn), s = std::sin(turn);
    return {c * direction.x - s * direction.z, direction.y, s * direction.x + c * direction.z};
}

glm::dvec3 Screen::screenFromStage(const glm::dvec3& point) const { return turnedFromStage(point - glm::dvec3(at.x, 0, at.y)); }

glm::dvec3 Screen::stageFromScreen(const glm::dvec3& point) const {
    const double c = std::cos(turn), s = std::sin(turn);
    return {at.x + c * point.x + s * point.z, point.y, at.y - s * point.x + c * point.z};
}

double Screen::distance(const glm::dvec3& point, glm::dvec3& outward) const {
    const glm::dvec3 p = screenFromStage(point);
    double distance = p.z;
    glm::dvec2 out(0, 1);  // (x, z)
    const double reach = std::abs(radius), beside = std::abs(p.x) - reach;
    const glm::dvec2 fromAxis(p.x, p.z - radius);
    if (radius > 0 && fromAxis.y < 0) {
        const double away = glm::length(fromAxis);
        distance = reach - away, out = -fromAxis / away;
        // From inside the wall, too, the way out is towards its front.
        if (beside > 0 && fromAxis.y > distance) distance = fromAxis.y, out = {0, 1};
    } else if (radius > 0) {
        const glm::dvec2 fromEdge(std::min(0.0, beside), fromAxis.y);
        distance = glm::length(fromEdge);
        if (distance > 0) out = glm::dvec2(std::copysign(fromEdge.x, -p.x), fromEdge.y) / distance;
    } else if (radius < 0 && fromAxis.y < 0) {
        distance = fromAxis.y + std::min(0.0, beside);
    } else if (radius < 0) {
        const double away = glm::length(fromAxis);
        distance = away - reach;
        if (beside > 0 && fromAxis.y < distance)
            distance = fromAxis.y;
        else if (away > 0)
            out = fromAxis / away;
    }
    const double c = std::cos(turn), s = std::sin(turn);
    outward = {c * out.x + s * out.y, 0, -s * out.x + c * out.y};
    return distance;
}

glm::dvec3 Screen::surface(glm::dvec2 unrolled) const {
    if (!isCurved()) return {unrolled, 0};
    const double angle = unrolled.x / radius, half = std::sin(0.5 * angle);
    return {radius * std::sin(angle), unrolled.y, 2 * radius * half * half};
}

std::optional<glm::dvec2> flatFromUnrolled(const Screen& screen, const glm::dvec3& light, glm::dvec2 unrolled) {
    if (!screen.isCurved()) return unrolled;
    const double angle = unrolled.x / screen.radius;
    if (std::abs(angle) > Screen::kMostArc) return std::nullopt;
    const glm::dvec3 point = screen.surface(unrolled), toLight = light - point;
    // A surface that faces away from the light is dark.
    if (toLight.z <= 0 || toLight.z * std::cos(angle) <= toLight.x * std::sin(angle)) return std::nullopt;
    return glm::dvec2(light) - light.z / toLight.z * glm::dvec2(toLight);
}

std::optional<glm::dvec2> unrolledFromFlat(const Screen& screen, const glm::dvec3& light, glm::dvec2 flat) {
    if (!screen.isCurved()) return flat;
    // The ray light + t way reaches the flat screen at t = 1. It meets the cylinder where a t^2 + 2
    // b t + c = 0.
    const glm::dvec3 way = glm::dvec3(flat, 0) - light;
    const glm::dvec2 along(way.x, way.z), from(light.x, light.z - screen.radius);
    const double a = glm::dot(along, along), b = glm::dot(along, from), c = glm::dot(from, from) - screen.radius * screen.radius;
    const double root = b * b - a * c;
    if (root < 0) return std::nullopt;
    // The ray meets a hollow screen where it leaves the cylinder, and a bulging one where it
    // enters.
    const double t = (-b + std::copysign(std::sqrt(root), screen.radius)) / a;
    const glm::dvec2 hit = (from + t * along) / screen.radius;  // (sine, -cosine) of the arc
    const double angle = std::atan2(hit.x, -hit.y);
    if (t <= 0 || std::abs(angle) > Screen::kMostArc) return std::nullopt;
    return glm::dvec2(screen.radius * angle, light.y + t * way.y);
}

}  // namespace fantascope::theatre
