#include "theatre/body/body.h"

#include "theatre/body/posed_body.h"
#include "theatre/random_turns.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace fantascope::theatre {
namespace {

using glm::dquat;
using glm::dvec3;

constexpr dquat kNoTurn{1, 0, 0, 0};

PosedBody atRest(const Body& body) {
    PosedBody posed;
    posed.pose(body, body.restPose(body.joints[0].offset, kNoTurn));
    return posed;
}
double top(const PosedBody& posed) {
    double top = 0;
    for (const PlacedCapsule& c : posed.capsules()) top = std::max({top, c.from.y + c.fromRadius, c.to.y + c.toRadius});
    return top;
}
// The pose at rest with one number of one joint.
PosedBody withNumber(const Body& body, std::string_view joint, std::size_t number, double value) {
    std::vector<double> pose = body.restPose(body.joints[0].offset, kNoTurn);
    pose[body.joints[body.joint(joint)].first + number] = value;
    PosedBody posed;
    posed.pose(body, pose);
    return posed;
}
std::string other(std::string name) { return name.starts_with("left ") ? "right " + name.substr(5) : name; }
dvec3 mirrored(const dvec3& p) { return {-p.x, p.y, p.z}; }
dquat mirrored(const dquat& q) { return {q.w, q.x, -q.y, -q.z}; }

class BodyOfStature : public testing::TestWithParam<double> {
protected:
    const Body body = humanBody(GetParam());
    const double stature = GetParam();
};
INSTANTIATE_TEST_SUITE_P(FromChildToTall, BodyOfStature, testing::Values(1.1, 1.7, 2.0));

TEST_P(BodyOfStature, stands_on_the_floor_and_is_as_high_as_asked) {
    const PosedBody posed = atRest(body);
    EXPECT_NEAR(posed.lowest(), 0, 1e-3);
    EXPECT_NEAR(top(posed), stature, 0.01 * stature);
}

// Segments as Winter 2009, figure 4.1, gives them; reach from finger to finger is a little more
// than the stature.
TEST_P(BodyOfStature, has_segments_of_anthropometric_lengths) {
    const PosedBody posed = atRest(body);
    const auto apart = [&](const char* a, const char* b) {
        return glm::distance(posed.place(body.joint(a)), posed.place(body.joint(b))) / stature;
    };
    EXPECT_NEAR(apart("left hip", "left knee"), 0.245, 0.001);
    EXPECT_NEAR(apart("left knee", "left ankle"), 0.246, 0.001);
    EXPECT_NEAR(apart("left shoulder", "left elbow"), 0.186, 0.001);
    EXPECT_NEAR(apart("left elbow", "left wrist"), 0.146, 0.001);
    EXPECT_NEAR(posed.place(body.joint("left ankle")).y / stature, 0.039, 0.001);
    double span = 0;
    for (const PlacedCapsule& c : posed.capsules())
        span = std::max({span, 2 * (c.from.x + c.fromRadius), 2 * (c.to.x + c.toRadius)});
    EXPECT_GT(span, 0.98 * stature);
    EXPECT_LT(span, 1.10 * stature);
}

TEST_P(BodyOfStature, weighs_twenty_two_times_its_squared_stature) {
    EXPECT_NEAR(body.mass(), 22 * stature * stature, 1e-3 * body.mass());
    double sum = 0;
    for (const Body::Joint& joint : body.joints) sum += joint.mass;
    EXPECT_DOUBLE_EQ(body.mass(), sum);
}

TEST(Body, ends_the_program_for_a_joint_that_it_has_not) {
    const Body body = humanBody(1.7);
    EXPECT_EQ(body.joints[body.joint("neck")].name, "neck");
    EXPECT_DEATH(static_cast<void>(body.joint("tail")), "a joint is named that the body has");
}

// In places, masses, girths, and in how its joints may turn.
TEST_P(BodyOfStature, mirrors_left_at_the_right) {
    const PosedBody posed = atRest(body);
    int pairs = 0;
    Rng rng(1);
    for (const Body::Joint& left : body.joints) {
        if (left.name.starts_with("right ")) continue;
        const Body::Joint& right = body.joints[body.joint(other(left.name))];
        pairs += &left != &right;
        EXPECT_LT(glm::distance(posed.place(body.joint(left.name)), mirrored(posed.place(body.joint(right.name)))), 1e-12);
        EXPECT_DOUBLE_EQ(left.mass, right.mass);
        EXPECT_LT(glm::distance(left.massCentre, mirrored(right.massCentre)), 1e-12);
        if (left.name == "pelvis") continue;
        ASSERT_EQ(left.motion.limits().size(), right.motion.limits().size());
        for (std::size_t i = 0; i < left.motion.limits().size(); ++i) {
            const JointLimit a = left.motion.limits()[i], b = right.motion.limits()[i];
            for (int k = 0; k < 20; ++k) {
                const dquat q = randomTurn(rng);
                // A mirrored turn about a mirrored axis has the other sign; those of the legs and
                // trunk are not mirrored.
                const double of = a.measure(q), ofMirrored = b.measure(mirrored(q));
                EXPECT_NEAR(std::abs(of), std::abs(ofMirrored), 1e-9) << left.name;
                const bool isWithin = of >= a.low && of <= a.high, isMirroredWithin = ofMirrored >= b.low && ofMirrored <= b.high;
                EXPECT_EQ(isWithin, isMirroredWithin) << left.name;
            }
        }
    }
    EXPECT_GE(pairs, 7);
    for (const PlacedCapsule& c : posed.capsules())
        EXPECT_TRUE(std::any_of(posed.capsules().begin(), posed.capsules().end(), [&](const PlacedCapsule& d) {
            const auto same = [&](const dvec3& from, double fromRadius, const dvec3& to, double toRadius) {
                return glm::distance(from, mirrored(c.from)) + glm::distance(to, mirrored(c.to)) < 1e-12 &&
                       std::abs(fromRadius - c.fromRadius) + std::abs(toRadius - c.toRadius) < 1e-12;
            };
            return same(d.from, d.fromRadius, d.to, d.toRadius) || same(d.to, d.toRadius, d.from, d.fromRadius);
        }));
}

TEST_P(BodyOfStature, rests_in_a_t_pose_within_the_limits) {
    std::vector<double> pose = body.restPose({1, 2, 3}, rotationOf({0, 1, 0}));
    PosedBody posed;
    posed.pose(body, pose);
    for (std::size_t i = 0; i < body.joints.size(); ++i)
        EXPECT_LT(angleBetween(posed.turn(i), rotationOf({0, 1, 0})), 1e-9) << body.joints[i].name;
    EXPECT_EQ(posed.place(0), dvec3(1, 2, 3));
    const std::vector<double> before = pose;
    body.limit(pose);
    EXPECT_THAT(pose, testing::Pointwise(testing::DoubleNear(1e-12), before));
}

TEST_P(BodyOfStature, has_degrees_of_freedom_numbered_without_gaps) {
    std::size_t next = Body::kRootDofs;
    for (std::size_t i = 1; i < body.joints.size(); ++i) {
        EXPECT_LT(body.joints[i].parent, i);
        EXPECT_EQ(body.joints[i].first, next);
        next += body.joints[i].motion.size();
    }
    EXPECT_EQ(body.dofs, next);
}

TEST_P(BodyOfStature, keeps_apart_pairs_that_are_neither_neighbours_nor_together_at_rest) {
    const PosedBody posed = atRest(body);
    std::set<std::pair<std::string, std::string>> joints;
    for (const auto& [i, j] : body.apart) {
        const std::uint32_t a = body.capsules[i].joint, b = body.capsules[j].joint;
        EXPECT_NE(a, b);
        EXPECT_NE(body.joints[a].parent, b);
        EXPECT_NE(body.joints[b].parent, a);
        EXPECT_LE(penetration(posed.capsule(i), posed.capsule(j)), 0);
        joints.insert({body.joints[a].name, body.joints[b].name});
        joints.insert({body.joints[b].name, body.joints[a].name});
    }
    // Those that people keep apart are in it.
    for (const auto& pair :
         {std::pair("left wrist", "neck"), std::pair("left elbow", "thorax"), std::pair("left knee", "right knee"),
          std::pair("left wrist", "right wrist"), std::pair("left wrist", "pelvis")})
        EXPECT_TRUE(joints.contains(pair)) << pair.first << ", " << pair.second;
}

TEST(HumanBody, bends_as_people_do) {
    const Body body = humanBody(1.7);
    const PosedBody rest = atRest(body);
    for (const std::string side : {"left ", "right "}) {
        const auto knee = body.joint(side + "knee"), ankle = body.joint(side + "ankle");
        EXPECT_LT(withNumber(body, side + "knee", 0, 1).place(ankle).z, rest.place(knee).z - 0.1);
        const auto elbow = body.joint(side + "elbow"), wrist = body.joint(side + "wrist");
        EXPECT_GT(withNumber(body, side + "elbow", 0, 1).place(wrist).z, rest.place(elbow).z + 0.1);
        // And not the other way.
        for (const std::string joint : {"knee", "elbow"}) {
            std::vector<double> pose = body.restPose(dvec3(0), kNoTurn);
            double& number = pose[body.joints[body.joint(side + joint)].first];
            number = -1;
            body.limit(pose);
            EXPECT_EQ(number, 0);
        }
    }
    // The spine's limits reach farther to the front, and there the head is before the hips.
    const auto turned = [&](double x) {
        const Body::Joint& lumbar = body.joints[body.joint("lumbar")];
        std::vector<double> pose = body.restPose(body.joints[0].offset, kNoTurn);
        lumbar.motion.numbers(rotationOf({x, 0, 0}), std::span(pose).subspan(lumbar.first, 3));
        PosedBody posed;
        posed.pose(body, pose);
        return posed.place(body.head).z;
    };
    EXPECT_GT(turned(2), 0.1);
    EXPECT_LT(turned(-2), -0.05);
    EXPECT_GT(turned(2), -turned(-2));
}

double angleOf(const dvec3& a, const dvec3& b) { return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)); }

// A thigh lifts to the front beyond the horizontal, hardly to the back; an arm hangs and points up.
TEST(HumanBody, reaches_where_people_do) {
    const Body body = humanBody(1.7);
    const auto far = [&](const char* joint, dvec3 axis, const dquat& turn) {
        const JointMotion& motion = body.joints[body.joint(joint)].motion;
        std::vector<double> numbers(motion.size());
        motion.numbers(turn, numbers);
        return glm::degrees(angleOf(motion.orientation(numbers) * axis, turn * axis));
    };
    EXPECT_LT(far("left hip", {0, -1, 0}, rotationOf({-1.9, 0, 0})), 1);
    EXPECT_GT(far("left hip", {0, -1, 0}, rotationOf({1.2, 0, 0})), 20);
    EXPECT_LT(far("left hip", {0, -1, 0}, rotationOf({0, 0, 0.7})), 1);
    EXPECT_GT(far("left hip", {0, -1, 0}, rotationOf({0, 0, -1.5})), 20);
    EXPECT_LT(far("left shoulder", {1, 0, 0}, rotationOf({0, 0, 1.4})), 1);
    EXPECT_LT(far("left shoulder", {1, 0, 0}, rotationOf({0, 0, -1.4})), 1);
    EXPECT_LT(far("left shoulder", {1, 0, 0}, rotationOf({0, -1.5, 0})), 1);
    EXPECT_GT(far("left shoulder", {1, 0, 0}, rotationOf({0, 1.7, 0})), 20);
}

TEST(Body, keeps_the_orientation_of_its_root_when_limited) {
    const Body body = humanBody(1.7);
    std::vector<double> pose = body.restPose({0, 1, 2}, kNoTurn);
    const dvec3 turn = 4.0 * glm::normalize(dvec3(1, 2, -2));
    for (int i = 0; i < 3; ++i) pose[static_cast<std::size_t>(i) + 3] = turn[i];
    body.limit(pose);
    const dvec3 limited(pose[3], pose[4], pose[5]);
    EXPECT_LE(glm::length(limited), std::numbers::pi);
    EXPECT_LT(angleBetween(rotationOf(limited), rotationOf(turn)), 1e-9);
}

}  // namespace
}  // namespace fantascope::theatre
