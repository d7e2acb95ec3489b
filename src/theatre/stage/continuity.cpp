#include "theatre/stage/continuity.h"

#include "theatre/body/balance.h"

#include <glm/geometric.hpp>

#include <cstdint>
#include <set>

namespace fantascope::theatre {
namespace {

double squareOf(const glm::dvec3& vector) { return glm::dot(vector, vector); }

}  // namespace

std::vector<HeldContact> bearingParts(const Body& body, const Stage& stage, const PosedBody& posed) {
    constexpr double kBears = 2 * kTouch;
    std::set<std::uint32_t> joints;
    for (std::size_t i = 0; i < body.spheres.size(); ++i) {
        const auto& [centre, radius] = posed.spheres()[i];
        if (centre.y - radius - stage.groundUnder(centre) <= kBears) joints.insert(body.spheres[i].joint);
    }
    std::vector<HeldContact> parts;
    for (const std::uint32_t joint : joints) parts.push_back({joint, posed.place(joint), posed.turn(joint)});
    return parts;
}

double poseDifference(const Body& body, std::span<const double> dofs, const ActorPose& other) {
    double turns = squareOf(turnBetween(other.turns[0], rotationOf({dofs[3], dofs[4], dofs[5]})));
    for (std::size_t i = 1; i < body.joints.size(); ++i) {
        const Body::Joint& joint = body.joints[i];
        const glm::dquat turn = joint.motion.orientation(dofs.subspan(joint.first, joint.motion.size()));
        turns += squareOf(turnBetween(other.turns[i], turn));
    }
    return kRootWeight * squareOf(glm::dvec3(dofs[0], dofs[1], dofs[2]) - other.root) + kTurnWeight * turns;
}

ContactDrift contactDrift(std::span<const HeldContact> contacts, const PosedBody& posed) {
    ContactDrift drift;
    for (const HeldContact& contact : contacts) {
        drift.place += 1e6 * squareOf(posed.place(contact.joint) - contact.place);
        drift.turn += squareOf(turnBetween(contact.turn, posed.turn(contact.joint)));
    }
    return drift;
}

}  // namespace fantascope::theatre
