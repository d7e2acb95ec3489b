#include "theatre/body/joint.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace fantascope::theatre {
namespace {

glm::dvec3 vectorPart(const glm::dquat& q) { return {q.x, q.y, q.z}; }

// Decomposes q = swing * twist. The twist is about a unit axis and less than half a turn.
struct SwingTwist {
    glm::dquat swing, twist;
};
SwingTwist decompose(const glm::dquat& q, const glm::dvec3& axis) {
    const double along = glm::dot(vectorPart(q), axis), length = std::hypot(q.w, along);
    if (length == 0) return {q, {1, 0, 0, 0}};  // after half a turn across the axis the twist is arbitrary
    const double sign = q.w < 0 ? -1 : 1;
    const glm::dquat twist(sign * q.w / length, sign * along / length * axis);
    return {q * glm::conjugate(twist), twist};
}

double angleAbout(const glm::dquat& twist, const glm::dvec3& axis) {
    return 2 * std::atan2(glm::dot(vectorPart(twist), axis), twist.w);
}

}  // namespace

glm::dquat rotationOf(const glm::dvec3& vector) {
    const double angle = glm::length(vector);
    // sin(x/2)/x as a series to the fourth order, where the quotient would lose digits.
    const double scale = angle < 1e-4 ? 0.5 - angle * angle / 48 : std::sin(angle / 2) / angle;
    return {std::cos(angle / 2), scale * vector};
}

glm::dvec3 vectorOf(const glm::dquat& rotation) {
    const glm::dvec3 vector = (rotation.w < 0 ? -1.0 : 1.0) * vectorPart(rotation);
    const double sine = glm::length(vector), cosine = std::abs(rotation.w);
    return sine < 1e-12 ? 2.0 * vector : 2 * std::atan2(sine, cosine) / sine * vector;
}

glm::dvec3 leftJacobian(const glm::dvec3& vector, const glm::dvec3& change) {
    const double angle = glm::length(vector), square = angle * angle;
    const double first = angle < 1e-4 ? 0.5 - square / 24 : (1 - std::cos(angle)) / square;
    const double second = angle < 1e-4 ? 1.0 / 6 - square / 120 : (angle - std::sin(angle)) / (square * angle);
    const glm::dvec3 once = glm::cross(vector, change);
    return change + first * once + second * glm::cross(vector, once);
}

double JointLimit::measure(const glm::dquat& orientation) const {
    const glm::dquat r = glm::conjugate(centre) * orientation;
    const glm::dvec3 vector = vectorPart(r);
    const double along = glm::dot(vector, axis);
    switch (kind) {
        case Kind::Axial:
            return angleAbout(decompose(r, axis).twist, axis);
        case Kind::Conic:
            return 2 * std::atan2(glm::length(vector - along * axis), std::hypot(r.w, along));
        case Kind::Spherical:
            return 2 * std::atan2(glm::length(vector), std::abs(r.w));
    }
    return 0;
}

JointMotion JointMotion::axial(glm::dvec3 axis, double low, double high) {
    JointMotion motion;
    motion.kind_ = Kind::Axial;
    motion.axis_ = axis;
    motion.low_ = low, motion.high_ = high;
    return motion;
}

JointMotion JointMotion::conicAxial(glm::dvec3 axis, glm::dquat centre, double cone, double low, double high) {
    JointMotion motion = axial(axis, low, high);
    motion.kind_ = Kind::ConicAxial;
    motion.centre_ = centre;
    motion.cone_ = cone;
    const glm::dvec3 other = std::abs(axis.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    motion.across_[0] = glm::normalize(other - glm::dot(other, axis) * axis);
    motion.across_[1] = glm::cross(axis, motion.across_[0]);
    return motion;
}

JointMotion JointMotion::conic(glm::dvec3 axis, glm::dquat centre, double cone) {
    JointMotion motion = conicAxial(axis, centre, cone, 0, 0);
    motion.kind_ = Kind::Conic;
    return motion;
}

JointMotion JointMotion::spherical(glm::dquat centre, double radius) {
    JointMotion motion;
    motion.kind_ = Kind::Spherical;
    motion.centre_ = centre;
    motion.cone_ = radius;
    return motion;
}

std::size_t JointMotion::size() const {
    switch (kind_) {
        case Kind::Axial:
            return 1;
        case Kind::Conic:
            return 2;
        case Kind::ConicAxial:
        case Kind::Spherical:
            return 3;
    }
    return 0;
}

glm::dvec3 JointMotion::swing(std::span<const double> numbers) const {
    if (kind_ == Kind::Spherical) return {numbers[0], numbers[1], numbers[2]};
    return numbers[0] * across_[0] + numbers[1] * across_[1];
}

glm::dquat JointMotion::orientation(std::span<const double> numbers) const {
    switch (kind_) {
        case Kind::Axial:
            return centre_ * rotationOf(numbers[0] * axis_);
        case Kind::Conic:
        case Kind::Spherical:
            return centre_ * rotationOf(swing(numbers));
        case Kind::ConicAxial:
            return centre_ * rotationOf(swing(numbers)) * rotationOf(numbers[2] * axis_);
    }
    return centre_;
}

void JointMotion::numbers(const glm::dquat& orientation, std::span<double> numbers) const {
    const glm::dquat r = glm::conjugate(centre_) * orientation;
    if (kind_ == Kind::Spherical) {
        const glm::dvec3 vector = vectorOf(r);
        for (int i = 0; i < 3; ++i) numbers[static_cast<std::size_t>(i)] = vector[i];
    } else {
        const SwingTwist parts = decompose(r, axis_);
        const glm::dvec3 swing = vectorOf(parts.swing);
        const double twist = angleAbout(parts.twist, axis_);
        if (kind_ == Kind::Axial) {
            numbers[0] = twist;
        } else {
            for (std::size_t i = 0; i < 2; ++i) numbers[i] = glm::dot(swing, across_[i]);
            if (kind_ == Kind::ConicAxial) numbers[2] = twist;
        }
    }
    limit(numbers);
}

void JointMotion::limit(std::span<double> numbers) const {
    if (kind_ == Kind::Axial) {
        numbers[0] = std::clamp(numbers[0], low_, high_);
        return;
    }
    const std::size_t swings = kind_ == Kind::Spherical ? 3 : 2;
    double square = 0;
    for (std::size_t i = 0; i < swings; ++i) square += numbers[i] * numbers[i];
    if (square > cone_ * cone_) {
        const double scale = cone_ / std::sqrt(square);
        for (std::size_t i = 0; i < swings; ++i) numbers[i] *= scale;
    }
    if (kind_ == Kind::ConicAxial) numbers[2] = std::clamp(numbers[2], low_, high_);
}

void JointMotion::axes(std::span<const double> numbers, std::span<glm::dvec3> axes) const {
    if (kind_ == Kind::Axial) {
        axes[0] = centre_ * axis_;
        return;
    }
    const glm::dvec3 vector = swing(numbers);
    if (kind_ == Kind::Spherical) {
        for (int i = 0; i < 3; ++i) {
            glm::dvec3 unit(0);
            unit[i] = 1;
            axes[static_cast<std::size_t>(i)] = centre_ * leftJacobian(vector, unit);
        }
        return;
    }
    for (std::size_t i = 0; i < 2; ++i) axes[i] = centre_ * leftJacobian(vector, across_[i]);
    if (kind_ == Kind::ConicAxial) axes[2] = centre_ * (rotationOf(vector) * axis_);
}

std::vector<JointLimit> JointMotion::limits() const {
    const JointLimit twist{JointLimit::Kind::Axial, axis_, centre_, low_, high_};
    const JointLimit tip{JointLimit::Kind::Conic, axis_, centre_, 0, cone_};
    switch (kind_) {
        case Kind::Axial:
            return {twist, {JointLimit::Kind::Conic, axis_, centre_, 0, 0}};
        case Kind::Conic:
        case Kind::ConicAxial:
            return {twist, tip};
        case Kind::Spherical:
            return {{JointLimit::Kind::Spherical, axis_, centre_, 0, cone_}};
    }
    return {};
}

}  // namespace fantascope::theatre
