#include "theatre/body/posed_body.h"

#include "theatre/random_turns.h"

#include <gmock/gmock.h>

namespace fantascope::theatre {
namespace {

using glm::dvec3;
using std::numbers::pi;

constexpr dvec3 kX{1, 0, 0}, kY{0, 1, 0}, kZ{0, 0, 1};

// Two rods of a metre, end to end along +x, the second hinged at the end of the first.
Body twoRods() {
    Body body;
    body.joints.resize(2);
    body.joints[0].mass = 3, body.joints[0].massCentre = {0.5, 0, 0};
    body.joints[1].mass = 1, body.joints[1].massCentre = {0.5, 0, 0};
    body.joints[1].offset = {1, 0, 0};
    body.joints[1].motion = JointMotion::axial(kZ, -pi, pi);
    body.joints[1].first = Body::kRootDofs;
    body.dofs = Body::kRootDofs + 1;
    body.spheres = {{0, {0, 0, 0}, 0.1}, {0, {1, 0, 0}, 0.2}, {1, {1, 0, 0}, 0.3}};
    body.capsules = {{0, 0, 1}, {1, 1, 2}};
    return body;
}

TEST(PosedBody, places_a_bent_rod_as_by_hand) {
    PosedBody posed;
    // The root at (5, 2, 0), turned from x to y; the hinge from there to -x.
    posed.pose(twoRods(), std::vector<double>{5, 2, 0, 0, 0, pi / 2, pi / 2});
    EXPECT_LT(glm::distance(posed.place(1), dvec3(5, 3, 0)), 1e-12);
    EXPECT_LT(glm::distance(posed.capsule(1).to, dvec3(4, 3, 0)), 1e-12);
    EXPECT_LT(glm::distance(posed.point(1, kY), dvec3(5, 2, 0)), 1e-12);
    EXPECT_LT(glm::distance(posed.massCentre(), 0.75 * dvec3(5, 2.5, 0) + 0.25 * dvec3(4.5, 3, 0)), 1e-12);
    EXPECT_NEAR(posed.lowest(), 1.9, 1e-12);
    EXPECT_NEAR(posed.capsule(1).reach, 0.8, 1e-12);
    EXPECT_EQ(posed.capsule(1).fromRadius, 0.2);
    EXPECT_EQ(posed.capsule(1).toRadius, 0.3);
}

TEST(PosedBody, is_lowest_at_either_end_of_a_capsule) {
    PosedBody posed;
    // Hanging: the second rod's far end is lowest.
    posed.pose(twoRods(), std::vector<double>{0, 5, 0, 0, 0, -pi / 2, 0});
    EXPECT_NEAR(posed.lowest(), 5 - 2 - 0.3, 1e-12);
}

TEST(PosedBody, has_axes_that_are_the_derivative_of_every_point) {
    const Body body = humanBody(1.7);
    Rng rng(1);
    for (int trial = 0; trial < 5; ++trial) {
        std::vector<double> pose(body.dofs);
        for (double& number : pose) number = rng.uniform(-2, 2);
        body.limit(pose);
        PosedBody posed, before, after;
        posed.pose(body, pose);
        std::vector<dvec3> axes(body.dofs);
        posed.axes(body, pose, axes);
        const double step = 1e-6;
        std::size_t joint = 0;
        for (std::size_t k = 0; k < body.dofs; ++k) {
            if (joint + 1 < body.joints.size() && k == body.joints[joint + 1].first) ++joint;
            std::vector<double> moved = pose;
            moved[k] -= step, before.pose(body, moved);
            moved[k] += 2 * step, after.pose(body, moved);
            for (std::size_t i = 0; i < body.joints.size(); ++i) {
                std::size_t ancestor = i;
                while (ancestor > joint) ancestor = body.joints[ancestor].parent;
                const dvec3 local(0.1, -0.2, 0.3), point = posed.point(i, local);
                const dvec3 expected = ancestor != joint ? dvec3(0)
                                       : k < 3           ? axes[k]
                                                         : glm::cross(axes[k], point - posed.place(joint));
                EXPECT_LT(glm::distance((after.point(i, local) - before.point(i, local)) / (2 * step), expected), 1e-7)
                    << k << ", " << body.joints[i].name;
            }
        }
    }
}

// Standing upright with the arms out people have it at some 56 to 58 % of their stature, over the
// feet.
TEST(PosedBody, has_the_mass_centre_of_a_t_pose_where_people_have_it) {
    const Body body = humanBody(1.8);
    PosedBody posed;
    posed.pose(body, body.restPose(body.joints[0].offset, {1, 0, 0, 0}));
    EXPECT_NEAR(posed.massCentre().x, 0, 1e-12);
    EXPECT_NEAR(posed.massCentre().y, 0.57 * 1.8, 0.03 * 1.8);
    EXPECT_NEAR(posed.massCentre().z, 0, 0.02 * 1.8);
}

PlacedCapsule capsule(dvec3 from, dvec3 to, double fromRadius, double toRadius) { return {{from, fromRadius}, {to, toRadius}}; }
void expectTouch(const PlacedCapsule& a, const PlacedCapsule& b, double depth, dvec3 onFirst, dvec3 onSecond) {
    for (const bool isSwapped : {false, true}) {
        const CapsuleTouch touch = isSwapped ? touching(b, a) : touching(a, b);
        EXPECT_NEAR(touch.depth, depth, 1e-12) << isSwapped;
        EXPECT_LT(glm::distance(isSwapped ? touch.onSecond : touch.onFirst, onFirst), 1e-12) << isSwapped;
        EXPECT_LT(glm::distance(isSwapped ? touch.onFirst : touch.onSecond, onSecond), 1e-12) << isSwapped;
        EXPECT_NEAR(glm::length(touch.normal), 1, 1e-12);
        if (onFirst != onSecond) {
            const dvec3 between = glm::normalize(onFirst - onSecond);
            EXPECT_LT(glm::distance(touch.normal, isSwapped ? -between : between), 1e-12) << isSwapped;
        }
    }
}

TEST(Touching, finds_how_deep_crossing_capsules_are) {
    // At a quarter of the first, in the middle of the second, .5 apart; radii .1 + .25 * .4 and .3.
    expectTouch(capsule({-1, 0, 0}, {3, 0, 0}, 0.1, 0.5), capsule({0, 0.5, -1}, {0, 0.5, 1}, 0.3, 0.3), 0.0, {0, 0, 0},
                {0, 0.5, 0});
}

TEST(Touching, finds_the_gap_beside_each_other_end_to_end_and_skew) {
    // An end of the one before the side of the other.
    expectTouch(capsule({0, 1, 0}, {0, 2, 0}, 0.1, 0.1), capsule({-2, 0, 0}, {2, 0, 0}, 0.2, 0.2), 0.3 - 1, {0, 1, 0}, {0, 0, 0});
    // In a line, with a gap.
    expectTouch(capsule({0, 0, 0}, {1, 0, 0}, 0.5, 0.2), capsule({3, 0, 0}, {2, 0, 0}, 0.5, 0.1), 0.3 - 1, {1, 0, 0}, {2, 0, 0});
    // Ends nearest, at right angles.
    expectTouch(capsule({0, 0, 0}, {1, 0, 0}, 0.5, 0.2), capsule({1, 1, 0}, {1, 3, 0}, 0.1, 0.9), 0.3 - 1, {1, 0, 0}, {1, 1, 0});
}

TEST(Touching, is_between_parallel_capsules_too) {
    const CapsuleTouch touch = touching(capsule({0, 0, 0}, {4, 0, 0}, 0.3, 0.3), capsule({1, 0.5, 0}, {3, 0.5, 0}, 0.3, 0.3));
    EXPECT_NEAR(touch.depth, 0.1, 1e-12);
    EXPECT_LT(glm::distance(touch.normal, -kY), 1e-12);
    EXPECT_NEAR(touch.onFirst.x, touch.onSecond.x, 1e-12);
}

TEST(Touching, goes_the_short_way_out_of_one_in_the_other) {
    const CapsuleTouch touch = touching(capsule({-2, 0, 0}, {2, 0, 0}, 1, 1), capsule({-1, 0, 0}, {1, 0, 0}, 0.2, 0.2));
    EXPECT_NEAR(touch.depth, 1.2, 1e-12);
    EXPECT_NEAR(glm::length(touch.normal), 1, 1e-12);
}

TEST(Touching, takes_capsules_without_a_length_for_balls) {
    const PlacedCapsule ball = capsule({3, 1, 0}, {3, 1, 0}, 0.4, 0.4);
    // Before the middle of a rod, beyond its end, and before another ball.
    expectTouch(ball, capsule({0, 0, 0}, {4, 0, 0}, 0.1, 0.5), 0.8 - 1, {3, 1, 0}, {3, 0, 0});
    expectTouch(ball, capsule({0, 1, 0}, {1, 1, 0}, 0.1, 0.1), 0.5 - 2, {3, 1, 0}, {1, 1, 0});
    expectTouch(ball, capsule({3, 3, 0}, {3, 3, 0}, 0.5, 0.5), 0.9 - 2, {3, 1, 0}, {3, 3, 0});
}

TEST(Touching, is_the_least_of_all_pairs_of_points) {
    Rng rng(2);
    for (int trial = 0; trial < 100; ++trial) {
        const PlacedCapsule a = capsule(randomVector(rng, 1), randomVector(rng, 1), 0.1, 0.1),
                            b = capsule(randomVector(rng, 1), randomVector(rng, 1), 0.2, 0.2);
        double least = 1e9;
        for (int i = 0; i <= 100; ++i)
            for (int j = 0; j <= 100; ++j)
                least = std::min(least, glm::distance(glm::mix(a.from, a.to, i / 100.0), glm::mix(b.from, b.to, j / 100.0)));
        const double distance = 0.3 - touching(a, b).depth;
        EXPECT_LE(distance, least + 1e-12);
        EXPECT_GE(distance, least - 0.02);
        EXPECT_TRUE(touching(a, b).depth <= 0 || areNear(a, b));
    }
}

}  // namespace
}  // namespace fantascope::theatre
