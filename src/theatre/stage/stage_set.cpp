#include "theatre/stage/stage_set.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace fantascope::theatre {
namespace {

using glm::dvec3;

constexpr int kMostSpheres = 16;  // sampled along a capsule, at most

// Samples a capsule by spheres no farther apart than the smaller end's radius, and finds the sphere
// that is deepest in an obstacle. `distance(point, outward)` is the signed distance to the
// obstacle.
template <class Distance>
void addDeepest(std::uint32_t joint, const PlacedCapsule& capsule, std::optional<std::uint32_t> otherJoint, Distance distance,
                std::vector<Intrusion>& intrusions) {
    dvec3 outward;
    if (distance(capsule.middle, outward) >= capsule.reach) return;
    const double apart = std::max(1e-3, std::min(capsule.fromRadius, capsule.toRadius));
    const int steps = std::clamp(static_cast<int>(std::ceil(glm::distance(capsule.from, capsule.to) / apart)), 1, kMostSpheres);
    Intrusion most{joint, {}, {}, 0, otherJoint};
    for (int i = 0; i <= steps; ++i) {
        const double share = double(i) / steps;
        const dvec3 centre = glm::mix(capsule.from, capsule.to, share);
        const double depth = std::lerp(capsule.fromRadius, capsule.toRadius, share) - distance(centre, outward);
        if (depth > most.depth) most.depth = depth, most.point = centre, most.outward = outward;
    }
    if (most.depth > 0) intrusions.push_back(most);
}

// The distance in a prop's grid is accurate to a cell.
double distanceTo(const PlacedProp& prop, const dvec3& point, dvec3& outward) {
    const double distance = prop.prop->shape->distance.at(glm::conjugate(prop.turn) * (point - prop.place), outward);
    outward = prop.turn * outward;
    return distance;
}

// The corner of a held prop that is deepest in an obstacle.
template <class Distance>
void addDeepestCorner(const PlacedProp& held, Distance distance, std::vector<Intrusion>& intrusions) {
    Intrusion most{held.joint, {}, {}, 0, std::nullopt};
    dvec3 outward;
    for (const glm::vec3& vertex : held.prop->shape->mesh.vertices) {
        const dvec3 point = held.point(vertex);
        if (const double depth = -distance(point, outward); depth > most.depth)
            most.depth = depth, most.point = point, most.outward = outward;
    }
    if (most.depth > 0) intrusions.push_back(most);
}

// Adds the shadows of flat, convex faces with the given corners.
class FaceShadow {
public:
    FaceShadow(const ScreenFrame& frame, std::span<const glm::vec3> places) : shadows_(places.size()), throws_(places.size()) {
        for (std::size_t i = 0; i < places.size(); ++i) {
            throws_[i] = frame.fromLight(places[i]).z > 1e-3;
            if (throws_[i] != 0) shadows_[i] = glm::vec2(frame.shadow(places[i]));
        }
    }
    void add(const glm::uvec3& face, BitMask& mask) {
        for (glm::length_t i = 0; i < 3; ++i)
            if (throws_[face[i]] == 0) return;
        filler_.fill({shadows_[face.x], shadows_[face.y], shadows_[face.z]}, mask);
    }

private:
    std::vector<glm::vec2> shadows_;
    std::vector<char> throws_;
    ConvexFiller filler_;
};

}  // namespace

std::span<const PlacedSphere> overFloor(const Stage& stage, std::span<const PlacedSphere> spheres,
                                        std::vector<PlacedSphere>& scratch) {
    if (stage.platforms.empty()) return spheres;
    scratch.assign(spheres.begin(), spheres.end());
    for (PlacedSphere& sphere : scratch) sphere.centre.y -= stage.groundUnder(sphere.centre);
    return scratch;
}

std::span<const glm::vec3> overFloor(const Stage& stage, std::span<const glm::vec3> points, std::vector<glm::vec3>& scratch) {
    if (stage.platforms.empty()) return points;
    scratch.assign(points.begin(), points.end());
    for (glm::vec3& point : scratch) point.y -= static_cast<float>(stage.groundUnder(point));
    return scratch;
}

double farthestOutside(const Stage& stage, const Contacts& contacts) {
    if (!stage.standing) return 0;
    double far = 0;
    for (const Contact& contact : contacts.discs) far = std::max(far, stage.standing->outside(contact.place));
    return far;
}

void placeStanding(const Stage& stage, std::vector<PlacedProp>& props) {
    props.clear();
    for (const Prop& prop : stage.props)
        if (!prop.holder) props.push_back({&prop, 0, prop.place, prop.turn});
}

void placeHeld(const Stage& stage, std::size_t actor, const Body& body, const PosedBody& posed, std::vector<PlacedProp>& props) {
    props.clear();
    for (const Prop& prop : stage.props)
        if (prop.holder && prop.holder->actor == actor) {
            const Body::Point& part = body.parts[static_cast<std::size_t>(prop.holder->part)];
            props.push_back(
                {&prop, part.joint, posed.point(part.joint, part.local + prop.place), posed.turn(part.joint) * prop.turn});
        }
}

void findIntrusions(const Stage& stage, std::span<const PlacedProp> standing, const Body& body, const PosedBody& posed,
                    std::span<const PlacedProp> held, std::vector<Intrusion>& intrusions) {
    intrusions.clear();
    for (const Stage::Platform& platform : stage.platforms) {
        const auto distance = [&](const dvec3& point, dvec3& outward) { return platform.distance(point, outward); };
        for (std::size_t i = 0; i < posed.capsules().size(); ++i)
            addDeepest(body.capsules[i].joint, posed.capsule(i), std::nullopt, distance, intrusions);
        for (const PlacedProp& prop : held) addDeepestCorner(prop, distance, intrusions);
    }
    for (const PlacedProp& prop : standing)
        for (std::size_t i = 0; i < posed.capsules().size(); ++i)
            addDeepest(
                body.capsules[i].joint, posed.capsule(i), std::nullopt,
                [&](const dvec3& point, dvec3& outward) { return distanceTo(prop, point, outward); }, intrusions);
    for (const PlacedProp& prop : held) {
        for (std::size_t i = 0; i < posed.capsules().size(); ++i) {
            const std::uint32_t joint = body.capsules[i].joint;
            if (joint == prop.joint || body.joints[joint].parent == prop.joint || body.joints[prop.joint].parent == joint)
                continue;
            addDeepest(
                joint, posed.capsule(i), prop.joint,
                [&](const dvec3& point, dvec3& outward) { return distanceTo(prop, point, outward); }, intrusions);
        }
        addDeepestCorner(
            prop,
            [](const dvec3& point, dvec3& outward) {
                outward = {0, 1, 0};
                return point.y;
            },
            intrusions);
        for (const Screen& screen : stage.screens)
            addDeepestCorner(
                prop, [&](const dvec3& point, dvec3& outward) { return screen.distance(point, outward); }, intrusions);
    }
}

void findIntrusions(const Body& body, const PosedBody& posed, std::span<const PlacedProp> heldByOther,
                    std::vector<Intrusion>& intrusions) {
    intrusions.clear();
    for (const PlacedProp& prop : heldByOther)
        for (std::size_t i = 0; i < posed.capsules().size(); ++i)
            addDeepest(
                body.capsules[i].joint, posed.capsule(i), prop.joint,
                [&](const dvec3& point, dvec3& outward) { return distanceTo(prop, point, outward); }, intrusions);
}

double squaredDepths(std::span<const Intrusion> intrusions) {
    double sum = 0;
    for (const Intrusion& intrusion : intrusions) sum += 1e6 * intrusion.depth * intrusion.depth;
    return sum;
}

double deepest(std::span<const Intrusion> intrusions) {
    double most = 0;
    for (const Intrusion& intrusion : intrusions) most = std::max(most, intrusion.depth);
    return most;
}

TriangleMesh meshOf(const Stage::Platform& platform) {
    TriangleMesh mesh;
    for (unsigned i = 0; i < 8; ++i) {
        const dvec3 side((i & 1U) != 0 ? 0.5 : -0.5, (i & 2U) != 0 ? 0.5 : -0.5, (i & 4U) != 0 ? 0.5 : -0.5);
        mesh.vertices.emplace_back(platform.point(side));
    }
    for (const glm::uvec4& q : {glm::uvec4(0, 2, 3, 1), {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}})
        mesh.triangles.insert(mesh.triangles.end(), {{q.x, q.y, q.z}, {q.x, q.z, q.w}});
    return mesh;
}

TriangleMesh meshOf(const PlacedProp& prop) {
    TriangleMesh mesh = prop.prop->shape->mesh;
    for (glm::vec3& vertex : mesh.vertices) vertex = prop.point(vertex);
    return mesh;
}

void addShadow(const ScreenFrame& frame, const TriangleMesh& mesh, BitMask& mask) {
    FaceShadow shadow(frame, mesh.vertices);
    for (const glm::uvec3& triangle : mesh.triangles) shadow.add(triangle, mask);
}

void cutToLit(const Stage& stage, const ScreenFrame& frame, BitMask& mask, std::size_t beam) {
    const auto lit = stage.beams[beam].lit;
    if (!lit) return;
    const auto first = [](double edge, int most) {
        return static_cast<int>(std::ceil(std::clamp(edge, 0.0, double(most)) - 0.5));
    };
    const glm::dvec2 leftTop = frame.pixelAt(lit->from.x, lit->to.y), rightBottom = frame.pixelAt(lit->to.x, lit->from.y);
    mask.keep(first(leftTop.x, mask.width()), first(leftTop.y, mask.height()), first(rightBottom.x, mask.width()),
              first(rightBottom.y, mask.height()));
}

}  // namespace fantascope::theatre
