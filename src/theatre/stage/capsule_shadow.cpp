#include "theatre/stage/capsule_shadow.h"

#include <glm/geometric.hpp>

#include <array>
#include <cmath>

namespace fantascope::theatre {
namespace {

// The sphere must clear the light by a little, since an unbounded shadow has no rows.
bool isBeforeLight(const glm::dvec3& fromLight, double radius) { return fromLight.z > 1.0001 * radius; }

}  // namespace

// The light's rays v that touch a sphere at d with radius r have (d.v)^2 = (d.d - r^2) v.v; with v
// = (x, y, 1) this is an ellipse in x and y. Its rows reach from y1 to y2, and row y reaches to
// both sides of its middle by the root of a multiple of (y - y1) (y2 - y).
bool CapsuleShadow::add(const ScreenFrame& frame, const PlacedSphere& sphere, BitMask& mask) {
    const glm::dvec3 d = frame.fromLight(sphere.centre);
    const double r = sphere.radius;
    if (!isBeforeLight(d, r)) return false;
    const double depth = d.z * d.z - r * r, upright = depth + d.y * d.y, focus = frame.focus();
    const double middle = d.y * d.z / depth, reach = r * std::sqrt(upright) / depth;
    const double top = frame.foot().y + focus * (middle - reach), bottom = frame.foot().y + focus * (middle + reach);
    // The rows whose centres lie between y1 and y2, clamped to the mask.
    const double height = mask.height();
    const int first = static_cast<int>(std::ceil(std::clamp(top, 0.0, height) - 0.5));
    const int last = static_cast<int>(std::floor(std::clamp(bottom, 0.0, height) - 0.5));
    if (first > last) return true;
    const auto rows = static_cast<std::size_t>(last - first + 1);
    left_.resize(rows);
    right_.resize(rows);
    const double slope = d.x * d.y / upright;
    const auto begin = static_cast<float>(frame.foot().x + focus * d.x * d.z / upright + slope * (first + 0.5 - frame.foot().y));
    const auto step = static_cast<float>(slope), spread = static_cast<float>(std::sqrt((upright + d.x * d.x) * depth) / upright);
    const auto fromTop = static_cast<float>(first + 0.5 - top), fromBottom = static_cast<float>(bottom - first - 0.5);
    for (std::size_t i = 0; i < rows; ++i) {
        const auto row = static_cast<float>(static_cast<int>(i));
        const float at = begin + step * row, half = spread * std::sqrt(std::max(0.0f, (fromTop + row) * (fromBottom - row)));
        left_[i] = at - half, right_[i] = at + half;
    }
    mask.fill(first, left_, right_);
    return true;
}

// The planes through the light that touch both spheres have the unit normals n with n.d = r for
// both: n = a d1 + b d2 +- c (d1 x d2).
void CapsuleShadow::addBetween(const ScreenFrame& frame, const PlacedCapsule& capsule, BitMask& mask) {
    const glm::dvec3 d1 = frame.fromLight(capsule.from), d2 = frame.fromLight(capsule.to);
    const double r1 = capsule.fromRadius, r2 = capsule.toRadius;
    const double aa = glm::dot(d1, d1), ab = glm::dot(d1, d2), bb = glm::dot(d2, d2);
    const glm::dvec3 across = glm::cross(d1, d2);
    const double square = glm::dot(across, across);
    const double a = r1 * bb - r2 * ab, b = r2 * aa - r1 * ab, rest = square - (a * r1 + b * r2);
    if (rest <= 0) return;  // one end's shadow contains the other's
    const glm::dvec3 common = (a * d1 + b * d2) / square, beside = std::sqrt(rest) / square * across;
    const auto shadow = [&](const glm::dvec3& p) { return glm::vec2(frame.foot() + frame.focus() / p.z * glm::dvec2(p)); };
    const glm::dvec3 one = common + beside, other = common - beside;
    const std::array<glm::vec2, 4> quadrilateral{shadow(d1 - r1 * one), shadow(d2 - r2 * one), shadow(d2 - r2 * other),
                                                 shadow(d1 - r1 * other)};
    filler_.fill(quadrilateral, mask);
}

bool CapsuleShadow::add(const ScreenFrame& frame, const PlacedCapsule& capsule, BitMask& mask) {
    if (!isBeforeLight(frame.fromLight(capsule.from), capsule.fromRadius) ||
        !isBeforeLight(frame.fromLight(capsule.to), capsule.toRadius))
        return false;
    add(frame, PlacedSphere{capsule.from, capsule.fromRadius}, mask);
    add(frame, PlacedSphere{capsule.to, capsule.toRadius}, mask);
    addBetween(frame, capsule, mask);
    return true;
}

bool CapsuleShadow::add(const ScreenFrame& frame, const PosedBody& body, BitMask& mask) {
    bool all = true;
    for (const PlacedSphere& sphere : body.spheres()) all &= add(frame, sphere, mask);
    for (const PlacedCapsule& capsule : body.capsules())
        if (all || (isBeforeLight(frame.fromLight(capsule.from), capsule.fromRadius) &&
                    isBeforeLight(frame.fromLight(capsule.to), capsule.toRadius)))
            addBetween(frame, capsule, mask);
    return all;
}

}  // namespace fantascope::theatre
