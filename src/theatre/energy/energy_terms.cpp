#include "theatre/energy/energy_terms.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace fantascope::theatre {
namespace {

double squaredMillimetres(double depth) { return depth > 0 ? 1e6 * depth * depth : 0; }

// Calls visit(depth) for the pairs of capsules that may touch.
template <class Visit>
void forPairs(const Body& body, const PosedBody& posed, Visit visit) {
    for (const auto& [a, b] : body.apart)
        if (areNear(posed.capsule(a), posed.capsule(b))) visit(penetration(posed.capsule(a), posed.capsule(b)));
}
template <class Visit>
void forPairs(const PosedBody& a, const PosedBody& b, Visit visit) {
    for (const PlacedCapsule& one : a.capsules())
        if (b.isNear(one))
            for (const PlacedCapsule& other : b.capsules())
                if (areNear(one, other)) visit(penetration(one, other));
}

// The floor and the first screen count once, by the greater depth. Each further screen counts on
// its own.
template <class Visit>
void forStage(const Stage& stage, const PosedBody& posed, Visit visit) {
    glm::dvec3 outward;
    const Screen& first = stage.screens[0];
    for (const auto& [centre, radius] : posed.spheres())
        visit(radius - std::min(centre.y, first.isCurved() ? first.distance(centre, outward) : centre.z));
    for (std::size_t i = 1; i < stage.screens.size(); ++i)
        for (const auto& [centre, radius] : posed.spheres()) visit(radius - stage.screens[i].distance(centre, outward));
}

}  // namespace

double unseen(const glm::dvec3& eyes, const glm::dvec3& gaze, const glm::dvec3& screenMiddle) {
    const glm::dvec3 wanted = screenMiddle - eyes;
    const double distance = glm::length(wanted);
    // Eyes exactly at the middle see it.
    const double off = distance > 0 ? std::acos(std::clamp(glm::dot(gaze, wanted) / distance, -1.0, 1.0)) - kSight : 0;
    // At more than a right angle from the cone's side, the apex is the nearest point.
    const double near = off <= 0 ? 0 : off < std::numbers::pi / 2 ? distance * std::sin(off) : distance;
    // The screen's plane is at z = 0: the cone reaches it if one of its rays goes towards -z.
    const double away = std::acos(std::clamp(-gaze.z, -1.0, 1.0)) - kSight - std::numbers::pi / 2;
    return near * near + (away > 0 ? kUnseen * (1 + away) : 0);
}

double lackOfMargin(double margin) {
    return 100 * (std::max(0.0, kAmpleMargin - margin) + (kUnsure - 1) * std::max(0.0, kSureMargin - margin));
}

double depthInItself(const Body& body, const PosedBody& posed) {
    double sum = 0;
    forPairs(body, posed, [&](double depth) { sum += squaredMillimetres(depth); });
    return sum;
}

double depthInOther(const PosedBody& a, const PosedBody& b) {
    double sum = 0;
    forPairs(a, b, [&](double depth) { sum += squaredMillimetres(depth); });
    return sum;
}

double depthInStage(const Stage& stage, const PosedBody& posed) {
    double sum = 0;
    forStage(stage, posed, [&](double depth) { sum += squaredMillimetres(depth); });
    return sum;
}

double deepestInItself(const Body& body, const PosedBody& posed) {
    double most = 0;
    forPairs(body, posed, [&](double depth) { most = std::max(most, depth); });
    return most;
}

double deepestInOther(const PosedBody& a, const PosedBody& b) {
    double most = 0;
    forPairs(a, b, [&](double depth) { most = std::max(most, depth); });
    return most;
}

double deepestInStage(const Stage& stage, const PosedBody& posed) {
    double most = 0;
    forStage(stage, posed, [&](double depth) { most = std::max(most, depth); });
    return most;
}

int ownerChanges(std::span<const int> owners) {
    const auto isSomebody = [](int owner) { return owner != kNobody; };
    const auto last = std::find_if(owners.rbegin(), owners.rend(), isSomebody);
    if (last == owners.rend()) return 0;
    int changes = 0;
    for (int before = *last; const int owner : owners)
        if (isSomebody(owner)) changes += owner != std::exchange(before, owner);
    return changes;
}

}  // namespace fantascope::theatre
