#pragma once

#include "theatre/body/body.h"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include <algorithm>

namespace fantascope::theatre {

// A sphere in the stage's frame, metres.
struct PlacedSphere {
    glm::dvec3 centre{0};
    double radius = 0;
};

// A cone with round ends in the stage's frame, metres.
struct PlacedCapsule {
    glm::dvec3 from{0}, to{0};
    double fromRadius = 0, toRadius = 0;
    glm::dvec3 middle{0};
    double reach = 0;  // radius of a ball around `middle` that contains the capsule

    PlacedCapsule() = default;
    PlacedCapsule(const PlacedSphere& one, const PlacedSphere& other)
        : from(one.centre),
          to(other.centre),
          fromRadius(one.radius),
          toRadius(other.radius),
          middle(0.5 * (from + to)),
          reach(0.5 * glm::distance(from, to) + std::max(fromRadius, toRadius)) {}
};

// Whether the bounding balls of two capsules meet. For most pairs they do not.
inline bool areNear(const PlacedCapsule& a, const PlacedCapsule& b) {
    const glm::dvec3 between = a.middle - b.middle;
    const double reach = a.reach + b.reach;
    return between.x * between.x + between.y * between.y + between.z * between.z < reach * reach;
}

// The closest approach of two capsules: the spheres around the nearest points of their axes.
struct CapsuleTouch {
    double depth = 0;                    // penetration of the spheres, metres; if negative, their distance
    glm::dvec3 onFirst{0}, onSecond{0};  // the spheres' centres
    glm::dvec3 normal{0, 1, 0};          // from the second to the first, unit
};
CapsuleTouch touching(const PlacedCapsule& a, const PlacedCapsule& b);
inline double penetration(const PlacedCapsule& a, const PlacedCapsule& b) { return touching(a, b).depth; }

// A body in a pose: forward kinematics of its joints and capsules. Metres, stage frame. Memory is
// reused from pose to pose.
// Thread: thread-bound.
class PosedBody {
public:
    void pose(const Body& body, std::span<const double> dofs);

    const glm::dvec3& place(std::size_t joint) const { return places_[joint]; }
    const glm::dquat& turn(std::size_t joint) const { return turns_[joint]; }
    std::span<const PlacedSphere> spheres() const { return spheres_; }
    const PlacedCapsule& capsule(std::size_t index) const { return capsules_[index]; }
    std::span<const PlacedCapsule> capsules() const { return capsules_; }
    glm::dvec3 massCentre() const { return massCentre_; }
    // A point of a joint's frame, in the stage's frame.
    glm::dvec3 point(std::size_t joint, const glm::dvec3& local) const { return places_[joint] + turns_[joint] * local; }
    glm::dvec3 point(const Body::Point& at) const { return point(at.joint, at.local); }
    // The height of the lowest point of the capsules.
    double lowest() const { return least_.y; }
    // Whether a capsule's bounding ball reaches into the body's bounding box.
    bool isNear(const PlacedCapsule& capsule) const {
        for (int i = 0; i < 3; ++i)
            if (capsule.middle[i] + capsule.reach < least_[i] || capsule.middle[i] - capsule.reach > most_[i]) return false;
        return true;
    }

    // The rotation axis of a small change of each degree of freedom, through the place of its
    // joint. The root's first three degrees of freedom are translations along x, y and z. `axes`
    // has body.dofs elements, in the stage's frame.
    void axes(const Body& body, std::span<const double> dofs, std::span<glm::dvec3> axes) const;

private:
    std::vector<glm::dvec3> places_;
    std::vector<glm::dquat> turns_;
    std::vector<PlacedSphere> spheres_;
    std::vector<PlacedCapsule> capsules_;
    glm::dvec3 massCentre_{0}, least_{0}, most_{0};  // least_, most_: the corners of the box around the spheres
};

}  // namespace fantascope::theatre
