#include "theatre/body/body.h"

#include "theatre/body/posed_body.h"

#include "core/check.h"
#include "core/geometry.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <numbers>

namespace fantascope::theatre {
namespace {

using glm::dvec3;

// A ball at a capsule's end, in shares of the stature; its place is that in the T-pose, from the
// floor's middle. Capsules that meet share a ball. Where they turn against each other, the ball
// lies on the joint, so that both see it in one place. The balls were fitted to humanMesh().
struct Ball {
    dvec3 place{0};
    double radius = 0;
};

// Builds a body in shares of the stature. The left side is mirrored to the right.
class Builder {
public:
    explicit Builder(double stature) : stature_(stature) { body_.stature = stature; }

    std::uint32_t root(dvec3 place) { return add("pelvis", 0, place, {}, 0); }
    // `place`: of the joint in the T-pose, from the floor's middle.
    std::uint32_t add(std::string name, std::uint32_t parent, dvec3 place, JointMotion motion, std::size_t dofs) {
        places_.push_back(place);
        Body::Joint joint;
        joint.name = std::move(name);
        joint.parent = parent;
        joint.offset = stature_ * (body_.joints.empty() ? place : place - places_[parent]);
        joint.motion = motion;
        joint.first = body_.dofs;
        body_.dofs += dofs;
        body_.joints.push_back(std::move(joint));
        return static_cast<std::uint32_t>(body_.joints.size() - 1);
    }
    std::uint32_t add(std::string name, std::uint32_t parent, dvec3 place, const JointMotion& motion) {
        return add(std::move(name), parent, place, motion, motion.size());
    }
    void capsule(std::uint32_t joint, const Ball& from, const Ball& to) {
        const std::uint32_t first = sphere(joint, from.place, from.radius);
        body_.capsules.push_back({joint, first, sphere(joint, to.place, to.radius)});
    }
    // `share`: the part of the skin's volume that is nearest to the joint's capsules. `centre`: its
    // mass centre.
    void mass(std::uint32_t joint, double share, dvec3 centre) {
        // Body mass index 22: the middle of what the World Health Organization calls normal.
        body_.joints[joint].mass = share * 22 * stature_ * stature_;
        body_.joints[joint].massCentre = stature_ * (centre - places_[joint]);
    }
    // A point on a ball's surface, in a direction.
    void part(BodyPart part, std::uint32_t joint, Ball ball, dvec3 direction) {
        body_.parts[static_cast<std::size_t>(part)] = {joint, local(joint, ball.place + ball.radius * glm::normalize(direction))};
    }
    dvec3 local(std::uint32_t joint, dvec3 place) const { return stature_ * (place - places_[joint]); }
    Body& body() { return body_; }

private:
    // An existing sphere is reused if it is on the same joint, or lies on the joint between the two
    // segments, where neither moves it.
    std::uint32_t sphere(std::uint32_t joint, dvec3 place, double radius) {
        for (std::uint32_t i = 0; i < ends_.size(); ++i) {
            const End& end = ends_[i];
            const bool isBetween = (body_.joints[joint].parent == end.joint && place == places_[joint]) ||
                                   (body_.joints[end.joint].parent == joint && place == places_[end.joint]);
            if (end.place == place && end.radius == radius && (end.joint == joint || isBetween)) return i;
        }
        ends_.push_back({joint, place, radius});
        body_.spheres.push_back({joint, local(joint, place), stature_ * radius});
        return static_cast<std::uint32_t>(ends_.size() - 1);
    }

    struct End {
        std::uint32_t joint;
        dvec3 place;
        double radius;
    };
    double stature_;
    Body body_;
    std::vector<dvec3> places_;
    std::vector<End> ends_;
};

glm::dquat about(dvec3 axis, double degrees) { return rotationOf(radians(degrees) * axis); }

constexpr dvec3 kX{1, 0, 0}, kY{0, 1, 0}, kZ{0, 0, 1};

// Leg and arm of one side: `side` is 1 on the left and -1 on the right.
void addLeg(Builder& b, std::uint32_t pelvis, double side) {
    const std::string s = side > 0 ? "left " : "right ";
    const auto at = [&](double x, double y, double z) { return dvec3(side * x, y, z); };
    // Flexion 120, extension 25, abduction 45 (more with the hip bent), rotation 45 both ways.
    const auto hip =
        b.add(s + "hip", pelvis, at(0.052, 0.530, 0),
              JointMotion::conicAxial(-kY, about(kZ, side * 12) * about(kX, -46), radians(72), radians(-45), radians(45)));
    const auto knee = b.add(s + "knee", hip, at(0.052, 0.285, 0), JointMotion::axial(kX, 0, radians(140)));
    // Plantarflexion 50, dorsiflexion 20, inversion 35.
    const auto ankle = b.add(s + "ankle", knee, at(0.052, 0.039, 0), JointMotion::conic(-kY, about(kX, 15), radians(35)));
    const Ball ofHip{at(0.052, 0.530, 0), 0.0518}, ofKnee{at(0.052, 0.285, 0), 0.0350}, ofAnkle{at(0.052, 0.039, 0), 0.0219};
    const Ball heel{at(0.0514, 0.0253, -0.0161), 0.0253}, bigToe{at(0.0431, 0.0118, 0.0998), 0.0118},
        smallToe{at(0.0715, 0.0118, 0.0988), 0.0118};
    b.capsule(hip, ofHip, ofKnee);
    b.capsule(knee, ofKnee, ofAnkle);
    b.capsule(ankle, heel, bigToe);
    b.capsule(ankle, heel, smallToe);
    const bool isLeft = side > 0;
    b.part(isLeft ? BodyPart::LeftHip : BodyPart::RightHip, pelvis, ofHip, side * kX);
    // The corner of a knee or elbow that is bent by a right angle: halfway between the two limbs.
    b.part(isLeft ? BodyPart::LeftKnee : BodyPart::RightKnee, hip, ofKnee, kZ - kY);
    b.part(isLeft ? BodyPart::LeftFoot : BodyPart::RightFoot, ankle, bigToe, kZ);
    b.mass(hip, 0.1014, at(0.0557, 0.4147, 0.0018));
    b.mass(knee, 0.0480, at(0.0520, 0.1789, -0.0006));
    b.mass(ankle, 0.0162, at(0.0538, 0.0177, 0.0309));
}

void addArm(Builder& b, std::uint32_t thorax, double side) {
    const std::string s = side > 0 ? "left " : "right ";
    const auto at = [&](double x, double y, double z) { return dvec3(side * x, y, z); };
    const dvec3 along = side * kX;
    // Elevation 30, depression 10, forward and back 20.
    const auto clavicle =
        b.add(s + "clavicle", thorax, at(0.016, 0.806, 0.010), JointMotion::conic(along, about(kZ, side * 8), radians(20)));
    // Up 180, forward 180, back 40, across the chest; rotation 80 both ways.
    const auto shoulder = b.add(s + "shoulder", clavicle, at(0.108, 0.812, 0),
                                JointMotion::conicAxial(along, about(kY, -side * 40), radians(112), radians(-80), radians(80)));
    const auto elbow = b.add(s + "elbow", shoulder, at(0.294, 0.812, 0), JointMotion::axial(-side * kY, 0, radians(148)));
    // Flexion 80, extension 70, to the sides 20 and 30; the forearm's rotation of 80 both ways is
    // here too.
    const auto wrist = b.add(s + "wrist", elbow, at(0.440, 0.812, 0),
                             JointMotion::conicAxial(along, {1, 0, 0, 0}, radians(55), radians(-80), radians(80)));
    const Ball ofShoulder{at(0.108, 0.812, 0), 0.0380}, ofElbow{at(0.294, 0.812, 0), 0.0253},
        ofWrist{at(0.440, 0.812, 0), 0.0193};
    b.capsule(clavicle, {at(0.0244, 0.7979, -0.0051), 0.0538}, ofShoulder);
    b.capsule(shoulder, ofShoulder, ofElbow);
    b.capsule(elbow, ofElbow, ofWrist);
    const Ball fingers{at(0.5290, 0.8112, -0.0030), 0.0090};
    b.capsule(wrist, ofWrist, fingers);
    b.capsule(wrist, ofWrist, {at(0.5180, 0.8070, 0.0262), 0.0090});  // thumb
    const bool isLeft = side > 0;
    b.part(isLeft ? BodyPart::LeftShoulder : BodyPart::RightShoulder, clavicle, ofShoulder, along + kY);
    b.part(isLeft ? BodyPart::LeftElbow : BodyPart::RightElbow, shoulder, ofElbow, along - kZ);
    b.part(isLeft ? BodyPart::LeftHand : BodyPart::RightHand, wrist, fingers, along);
    b.mass(clavicle, 0.0415, at(0.0561, 0.8105, -0.0041));
    b.mass(shoulder, 0.0437, at(0.1917, 0.8120, 0));
    b.mass(elbow, 0.0179, at(0.3616, 0.8121, 0));
    b.mass(wrist, 0.0053, at(0.4750, 0.8111, 0.0034));
}

std::vector<std::array<std::uint32_t, 2>> pairsApart(const Body& body) {
    PosedBody atRest;
    atRest.pose(body, std::vector<double>(body.restPose(dvec3(0), {1, 0, 0, 0})));
    std::vector<std::array<std::uint32_t, 2>> pairs;
    for (std::uint32_t i = 0; i < body.capsules.size(); ++i)
        for (std::uint32_t j = i + 1; j < body.capsules.size(); ++j) {
            const std::uint32_t a = body.capsules[i].joint, b = body.capsules[j].joint;
            const bool neighbours = a == b || body.joints[a].parent == b || body.joints[b].parent == a;
            if (!neighbours && penetration(atRest.capsule(i), atRest.capsule(j)) <= 0) pairs.push_back({i, j});
        }
    return pairs;
}

}  // namespace

Body humanBody(double stature) {
    Builder b(stature);
    const auto pelvis = b.root({0, 0.530, 0});
    // Bending forward 85, back 35, sideways 35, turning 35, in two places.
    const auto lumbar = b.add("lumbar", pelvis, {0, 0.590, -0.010}, JointMotion::spherical(about(kX, 14), radians(36)));
    const auto thorax = b.add("thorax", lumbar, {0, 0.680, -0.012}, JointMotion::spherical(about(kX, 8), radians(28)));
    // 45 every way, rotation 60.
    const auto neck = b.add("neck", thorax, {0, 0.830, -0.004},
                            JointMotion::conicAxial(kY, {1, 0, 0, 0}, radians(45), radians(-60), radians(60)));

    // Two columns side by side are the trunk's width; the waist is one lying capsule.
    for (const double side : {1.0, -1.0}) {
        const auto at = [&](double x, double y, double z) { return dvec3(side * x, y, z); };
        b.capsule(pelvis, {at(0.0335, 0.5263, -0.0080), 0.0648}, {at(0.0191, 0.6146, -0.0027), 0.0604});
        b.capsule(thorax, {at(0.0187, 0.6804, 0.0021), 0.0600}, {at(0.0296, 0.7601, -0.0018), 0.0620});
    }
    b.capsule(lumbar, {{-0.0190, 0.6498, 0.0004}, 0.0584}, {{0.0190, 0.6498, 0.0004}, 0.0584});
    const Ball crown{{0, 0.9482, 0.0046}, 0.0508};
    b.capsule(neck, {{0, 0.830, -0.004}, 0.0315}, crown);
    b.capsule(neck, crown, {{0, 0.9020, 0.0270}, 0.0360});  // jaw
    b.part(BodyPart::Head, neck, crown, kY);
    b.part(BodyPart::Neck, neck, {{0, 0.855, -0.002}, 0.033}, -kZ);
    b.part(BodyPart::Chest, thorax, {{0, 0.745, -0.001}, 0.0616}, kZ);
    b.part(BodyPart::Pelvis, pelvis, {{0, 0.545, -0.007}, 0.064}, -kZ);
    b.mass(neck, 0.0688, {0, 0.9209, 0.0051});
    b.mass(thorax, 0.1621, {0, 0.7264, 0.0007});
    b.mass(lumbar, 0.0343, {0, 0.6489, 0.0010});
    b.mass(pelvis, 0.1868, {0, 0.5621, -0.0087});
    for (const double side : {1.0, -1.0}) addArm(b, thorax, side);
    for (const double side : {1.0, -1.0}) addLeg(b, pelvis, side);

    Body body = std::move(b.body());
    body.apart = pairsApart(body);
    body.head = neck;
    body.eyes = b.local(neck, {0, 0.936, 0.050});
    return body;
}

double Body::mass() const {
    double sum = 0;
    for (const Joint& joint : joints) sum += joint.mass;
    return sum;
}

std::uint32_t Body::joint(std::string_view name) const {
    const auto found = std::find_if(joints.begin(), joints.end(), [&](const Joint& joint) { return joint.name == name; });
    FANTASCOPE_CHECK(found != joints.end(), "a joint is named that the body has");
    return static_cast<std::uint32_t>(found - joints.begin());
}

std::vector<double> Body::restPose(glm::dvec3 rootPosition, const glm::dquat& rootOrientation) const {
    std::vector<double> pose(dofs, 0);
    const dvec3 turn = vectorOf(rootOrientation);
    for (int i = 0; i < 3; ++i)
        pose[static_cast<std::size_t>(i)] = rootPosition[i], pose[static_cast<std::size_t>(i) + 3] = turn[i];
    for (std::size_t i = 1; i < joints.size(); ++i)
        joints[i].motion.numbers({1, 0, 0, 0}, std::span(pose).subspan(joints[i].first, joints[i].motion.size()));
    return pose;
}

void Body::limit(std::span<double> dofs) const {
    const dvec3 turn(dofs[3], dofs[4], dofs[5]);
    if (glm::length(turn) > std::numbers::pi) {
        const dvec3 same = vectorOf(rotationOf(turn));
        for (int i = 0; i < 3; ++i) dofs[static_cast<std::size_t>(i) + 3] = same[i];
    }
    for (std::size_t i = 1; i < joints.size(); ++i)
        joints[i].motion.limit(dofs.subspan(joints[i].first, joints[i].motion.size()));
}

}  // namespace fantascope::theatre
