#pragma once

#include "theatre/body/body_part.h"
#include "theatre/body/joint.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace fantascope::theatre {

// A sphere fixed to a joint; metres, in the joint's frame.
struct Sphere {
    std::uint32_t joint = 0;
    glm::dvec3 centre{0};
    double radius = 0;
};

// A cone with round ends, fixed to a joint: the hull of two of the body's spheres.
struct Capsule {
    std::uint32_t joint = 0;
    std::uint32_t from = 0, to = 0;  // spheres of this joint's, or at the place of a joint that hangs on it
};

// A body of rigid segments that turn about joints (Won & Lee 2016, section 3: M_n = (v_0, q_0, q_1
// .. q_M)). Joint 0 is the root; a joint's parent comes before it. The rest pose is a T-pose that
// stands on the floor, looks along +z and has +y up and its left side at +x: all q are 1 in it.
// Metres, kilograms, radians.
//
// Its degrees of freedom are numbers in the order of the joints: first the root's position and
// rotation vector, in the stage's frame, then those of each joint's motion.
struct Body {
    struct Joint {
        std::string name;
        std::uint32_t parent = 0;
        glm::dvec3 offset{0};   // from the parent, in its frame, at rest
        JointMotion motion;     // of all but the root
        std::size_t first = 0;  // of its numbers
        double mass = 0;        // of the segment that turns with it
        glm::dvec3 massCentre{0};
    };
    static constexpr std::size_t kRootDofs = 6;
    // A step of a search that is neither large nor small: metres for the root's place, radians for
    // all else.
    static constexpr double scaleOf(std::size_t dof) { return dof < 3 ? 0.3 : dof < kRootDofs ? 0.5 : 0.35; }

    double stature = 0;
    std::vector<Joint> joints;
    std::vector<Sphere> spheres;
    std::vector<Capsule> capsules;  // the ends of those that meet are one sphere
    // The pairs of capsules that must not run into each other: neither on one joint or on
    // neighbours, nor in each other at rest.
    std::vector<std::array<std::uint32_t, 2>> apart;
    std::size_t dofs = kRootDofs;
    glm::dvec3 eyes{0}, gaze{0, 0, 1};  // in the head's frame
    std::uint32_t head = 0;
    // Where each BodyPart is: a point of the skin, fixed to a joint, in its frame. Of limbs it is
    // the outermost tip: fingers, toes, the elbow's and the knee's corner as they bend, the
    // shoulder's and the hip's side; the crown; the nape; the breastbone; the seat.
    struct Point {
        std::uint32_t joint = 0;
        glm::dvec3 local{0};
    };
    std::array<Point, kBodyParts> parts{};

    double mass() const;
    // Must be the name of one of the joints: another ends the program.
    std::uint32_t joint(std::string_view name) const;
    // The numbers of the rest pose, its root at a place; joints whose limits exclude it are as near
    // to it as they can.
    std::vector<double> restPose(glm::dvec3 rootPosition, const glm::dquat& rootOrientation) const;
    // Brings all numbers within the limits, the root's rotation vector to no more than pi.
    void limit(std::span<double> dofs) const;
};

// A person of this stature, metres. Lengths of segments: Drillis & Contini 1966 (after Winter 2009,
// figure 4.1); masses and their centres: the volume of humanMesh(),
// docs/decisions/0038-a-body-weighs-what-its-skin-holds.md; girths: mean circumferences of adults,
// as shares of the stature; limits: ranges of motion of the American Academy of Orthopaedic
// Surgeons 1965 (after Norkin & White 2016), put into cones and balls.
Body humanBody(double stature);

}  // namespace fantascope::theatre
