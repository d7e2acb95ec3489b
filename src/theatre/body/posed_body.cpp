#include "theatre/body/posed_body.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace fantascope::theatre {

// The nearest points of two segments: Ericson 2005, section 5.1.9. The shift by the taper is
// neglected, since girths change little along a limb.
CapsuleTouch touching(const PlacedCapsule& a, const PlacedCapsule& b) {
    const glm::dvec3 along = a.to - a.from, other = b.to - b.from, between = a.from - b.from;
    const double aa = glm::dot(along, along), bb = glm::dot(other, other), ab = glm::dot(along, other);
    const double c = glm::dot(along, between), f = glm::dot(other, between), crossing = aa * bb - ab * ab;
    double s = crossing > 1e-12 * aa * bb ? std::clamp((ab * f - c * bb) / crossing, 0.0, 1.0) : 0;
    double t = bb > 0 ? (ab * s + f) / bb : 0;
    if (bb == 0 || t < 0 || t > 1) {
        t = std::clamp(t, 0.0, 1.0);
        s = aa > 0 ? std::clamp((ab * t - c) / aa, 0.0, 1.0) : 0;
    }
    CapsuleTouch touch;
    touch.onFirst = a.from + s * along;
    touch.onSecond = b.from + t * other;
    const glm::dvec3 apart = touch.onFirst - touch.onSecond;
    const double distance = glm::length(apart);
    if (distance > 0) touch.normal = apart / distance;
    touch.depth = std::lerp(a.fromRadius, a.toRadius, s) + std::lerp(b.fromRadius, b.toRadius, t) - distance;
    return touch;
}

void PosedBody::pose(const Body& body, std::span<const double> dofs) {
    places_.resize(body.joints.size());
    turns_.resize(body.joints.size());
    spheres_.resize(body.spheres.size());
    capsules_.resize(body.capsules.size());
    places_[0] = {dofs[0], dofs[1], dofs[2]};
    turns_[0] = rotationOf({dofs[3], dofs[4], dofs[5]});
    glm::dvec3 moment(0);
    double mass = 0;
    for (std::size_t i = 0; i < body.joints.size(); ++i) {
        const Body::Joint& joint = body.joints[i];
        if (i > 0) {
            places_[i] = point(joint.parent, joint.offset);
            turns_[i] = turns_[joint.parent] * joint.motion.orientation(dofs.subspan(joint.first, joint.motion.size()));
        }
        moment += joint.mass * point(i, joint.massCentre);
        mass += joint.mass;
    }
    massCentre_ = moment / mass;
    least_ = glm::dvec3(std::numeric_limits<double>::infinity());
    most_ = -least_;
    for (std::size_t i = 0; i < spheres_.size(); ++i) {
        const Sphere& sphere = body.spheres[i];
        const PlacedSphere placed = spheres_[i] = {point(sphere.joint, sphere.centre), sphere.radius};
        least_ = glm::min(least_, placed.centre - placed.radius);
        most_ = glm::max(most_, placed.centre + placed.radius);
    }
    for (std::size_t i = 0; i < capsules_.size(); ++i)
        capsules_[i] = {spheres_[body.capsules[i].from], spheres_[body.capsules[i].to]};
}

void PosedBody::axes(const Body& body, std::span<const double> dofs, std::span<glm::dvec3> axes) const {
    for (int i = 0; i < 3; ++i) {
        glm::dvec3 unit(0);
        unit[i] = 1;
        axes[static_cast<std::size_t>(i)] = unit;
        axes[static_cast<std::size_t>(i) + 3] = leftJacobian({dofs[3], dofs[4], dofs[5]}, unit);
    }
    for (std::size_t i = 1; i < body.joints.size(); ++i) {
        const Body::Joint& joint = body.joints[i];
        const auto own = axes.subspan(joint.first, joint.motion.size());
        joint.motion.axes(dofs.subspan(joint.first, own.size()), own);
        for (glm::dvec3& axis : own) axis = turns_[joint.parent] * axis;
    }
}

}  // namespace fantascope::theatre
