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
    std::uint32_t from = 0, to = 0;  // indices of spheres on this joint, or at the place of a child joint
};

// A body of rigid segments that turn about joints (Won & Lee 2016, section 3: M_n = (v_0, q_0, q_1
// .. q_M)). Joint 0 is the root; a joint's parent comes before it. The rest pose is a T-pose that
// stands on the floor, looks along +z and has +y up and its left side at +x: all q are 1 in it.
// Metres, kilograms, radians.
//
// Its degrees of freedom are numbers: first the root's position and rotation vector in the stage's
// frame, then those of each JointMotion, in the order of the joints.
struct Body {
    struct Joint {
        std::string name;
        std::uint32_t parent = 0;
        glm::dvec3 offset{0};   // from the parent, in its frame, at rest
        JointMotion motion;     // of all but the root
        std::size_t first = 0;  // index of its first degree of freedom
        double mass = 0;        // of the segment that turns with it, kilograms
        glm::dvec3 massCentre{0};
    };
    static constexpr std::size_t kRootDofs = 6;
    // The typical search step of a degree of freedom: metres for the root's position, radians for
    // all others.
    static constexpr double scaleOf(std::size_t dof) { return dof < 3 ? 0.3 : dof < kRootDofs ? 0.5 : 0.35; }

    double stature = 0;
    std::vector<Joint> joints;
    std::vector<Sphere> spheres;
    std::vector<Capsule> capsules;  // capsules that meet share a sphere
    // The pairs of capsules that must not penetrate each other. Pairs on one joint or on adjacent
    // joints, and pairs that overlap at rest, are left out.
    std::vector<std::array<std::uint32_t, 2>> apart;
    std::size_t dofs = kRootDofs;
    glm::dvec3 eyes{0}, gaze{0, 0, 1};  // in the head's frame
    std::uint32_t head = 0;
    // Where each BodyPart is: a point of the skin, in the frame of its joint. It is the outermost
    // tip of a hand or foot, the corner of a bent elbow or knee, the side of a shoulder or hip, the
    // crown, the nape, the breastbone, or the seat.
    struct Point {
        std::uint32_t joint = 0;
        glm::dvec3 local{0};
    };
    std::array<Point, kBodyParts> parts{};

    double mass() const;
    // The index of a joint. An unknown name ends the program.
    std::uint32_t joint(std::string_view name) const;
    // The degrees of freedom of the rest pose with the root at a given place. A joint whose limits
    // exclude the rest pose takes the nearest orientation it can.
    std::vector<double> restPose(glm::dvec3 rootPosition, const glm::dquat& rootOrientation) const;
    // Clamps all degrees of freedom to the joint limits, and the root's rotation vector to a length
    // of pi.
    void limit(std::span<double> dofs) const;
};

// A person of this stature in metres. Lengths of segments: Drillis & Contini 1966 (after Winter
// 2009, figure 4.1); masses and their centres: the volume of humanMesh(),
// docs/decisions/0038-a-body-weighs-what-its-skin-holds.md; girths: mean circumferences of adults,
// as shares of the stature; limits: ranges of motion of the American Academy of Orthopaedic
// Surgeons 1965 (after Norkin & White 2016), put into cones and balls.
Body humanBody(double stature);

}  // namespace fantascope::theatre
