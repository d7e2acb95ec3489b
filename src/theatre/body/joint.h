#pragma once

#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>

#include <span>
#include <string>
#include <vector>

namespace fantascope::theatre {

// One bound on a joint's orientation in unit quaternion space: the angle measure gamma of a
// quaternion (Lee 2000, chapter on joint limits; Won & Lee 2016, section 4), and its min and max in
// radians. With r = centre^-1 q:
//   Axial      the signed rotation about `axis` that is part of r, -pi .. pi
//   Conic      the angle by which r tips `axis`, 0 .. pi
//   Spherical  the geodesic distance of r from no rotation, 0 .. pi
// q and -q are the same orientation and measure the same.
struct JointLimit {
    enum class Kind { Axial, Conic, Spherical };
    Kind kind = Kind::Axial;
    glm::dvec3 axis{1, 0, 0};
    glm::dquat centre{1, 0, 0, 0};
    double low = 0, high = 0;

    double measure(const glm::dquat& orientation) const;
};

// How a joint rotates relative to its parent, and its parametrisation for a search: q = centre *
// swing * twist. Every number is an angle in radians. Within the limits, numbers and orientations
// correspond one to one.
//   Axial       1: the rotation about the axis                                (elbow, knee)
//   Conic       2: the rotation vector's parts across the axis, no twist      (clavicle, ankle)
//   ConicAxial  3: those, and the twist about the axis                        (shoulder, wrist, hip, neck)
//   Spherical   3: the rotation vector                                        (spine)
// Thread: reentrant.
class JointMotion {
public:
    enum class Kind { Axial, Conic, ConicAxial, Spherical };

    // Axis: unit. Angles in radians.
    static JointMotion axial(glm::dvec3 axis, double low, double high);
    static JointMotion conic(glm::dvec3 axis, glm::dquat centre, double cone);
    static JointMotion conicAxial(glm::dvec3 axis, glm::dquat centre, double cone, double low, double high);
    static JointMotion spherical(glm::dquat centre, double radius);

    Kind kind() const { return kind_; }
    std::size_t size() const;  // the number of degrees of freedom, 1 .. 3
    glm::dquat orientation(std::span<const double> numbers) const;
    // The numbers nearest to an orientation that this joint can take.
    void numbers(const glm::dquat& orientation, std::span<double> numbers) const;
    // Clamps the numbers to the limits: the twist and the length of the swing.
    void limit(std::span<double> numbers) const;
    // The rotation axis of a small change of each number, in the parent's frame: d q = 1/2 axis q.
    void axes(std::span<const double> numbers, std::span<glm::dvec3> axes) const;
    // The bounds as measures of an orientation.
    std::vector<JointLimit> limits() const;

private:
    glm::dvec3 swing(std::span<const double> numbers) const;

    Kind kind_ = Kind::Axial;
    glm::dvec3 axis_{1, 0, 0}, across_[2] = {{0, 1, 0}, {0, 0, 1}};
    glm::dquat centre_{1, 0, 0, 0};
    double cone_ = 0, low_ = 0, high_ = 0;
};

// The exponential map gives a rotation by the length of a vector about its direction. Its inverse
// gives the rotation vector, no longer than pi.
glm::dquat rotationOf(const glm::dvec3& vector);
glm::dvec3 vectorOf(const glm::dquat& rotation);

// The left Jacobian J of the exponential map, applied to dv: exp(v + dv) = exp(J dv) exp(v) to
// first order.
glm::dvec3 leftJacobian(const glm::dvec3& vector, const glm::dvec3& change);

}  // namespace fantascope::theatre
