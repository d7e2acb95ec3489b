#include "theatre/capsule_shadow.h"

#include <cmath>
#include <numbers>

namespace fantascope::theatre {
namespace {

// The directions in which a shadow is felt, as columns: loops over them are vectors.
struct Directions {
    std::array<float, CapsuleShadow::kDirections> x, y;
};
const Directions& directions() {
    static const Directions table = [] {
        Directions directions;
        for (std::size_t i = 0; i < directions.x.size(); ++i) {
            const double angle = 2 * std::numbers::pi * static_cast<double>(i) / CapsuleShadow::kDirections;
            directions.x[i] = static_cast<float>(std::cos(angle)), directions.y[i] = static_cast<float>(std::sin(angle));
        }
        return directions;
    }();
    return table;
}

}  // namespace

// How far the shadow of a sphere reaches in each direction n, and where it does, in units of the light's distance. `d`: the centre from the light.
void CapsuleShadow::feel(const glm::vec3& d, float radius, Reach& reach) {
    const Directions& n = directions();
    const float depth = d.z * d.z - radius * radius, inverse = 1 / depth;
    for (std::size_t i = 0; i < kDirections; ++i) {
        const float p = n.x[i] * d.x + n.y[i] * d.y, q = n.x[i] * d.y - n.y[i] * d.x;
        // (p - h z)^2 = r^2 (1 + h^2): the plane through the light that meets the screen in the line at h along n touches the sphere.
        const float root = std::sqrt(p * p + depth);
        const float far = (d.z * p + radius * root) * inverse;
        const float slope = q * (d.z + radius * p / root) * inverse;
        reach.far[i] = far;
        reach.x[i] = far * n.x[i] - slope * n.y[i];
        reach.y[i] = far * n.y[i] + slope * n.x[i];
    }
}

bool CapsuleShadow::add(const ScreenFrame& frame, const PlacedCapsule& capsule, BitMask& mask) {
    const glm::vec3 from = frame.fromLight(capsule.from), to = frame.fromLight(capsule.to);
    const auto fromRadius = static_cast<float>(capsule.fromRadius), toRadius = static_cast<float>(capsule.toRadius);
    if (from.z <= fromRadius || to.z <= toRadius) return false;
    feel(from, fromRadius, from_);
    feel(to, toRadius, to_);
    const glm::vec2 foot = frame.foot();
    const auto focus = static_cast<float>(frame.focus());
    for (std::size_t i = 0; i < kDirections; ++i) {
        const bool first = from_.far[i] > to_.far[i];
        outline_[i] = foot + focus * glm::vec2(first ? from_.x[i] : to_.x[i], first ? from_.y[i] : to_.y[i]);
    }
    filler_.fill(outline_, mask);
    return true;
}

}  // namespace fantascope::theatre
