#include "theatre/energy/energy_terms.h"

#include "theatre/energy/pose_weights.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

namespace fantascope::theatre {
namespace {

using glm::dvec3;
using std::numbers::pi;

// Eyes 4 m before the middle of the screen, turned by an angle to the side.
double turned(double angle) { return unseen({1, 2, 4}, {std::sin(angle), 0, -std::cos(angle)}, {1, 2, 0}); }

TEST(Unseen, is_nothing_in_sight) {
    EXPECT_NEAR(turned(0), 0, 1e-9);
    EXPECT_NEAR(turned(0.99 * kSight), 0, 1e-9);
    EXPECT_EQ(unseen({1, 2, 0}, {0, 0, -1}, {1, 2, 0}), 0) << "eyes at the screen's middle";
    EXPECT_NEAR(turned(-0.99 * kSight), 0, 1e-9);
}

TEST(Unseen, is_the_squared_distance_to_the_cones_side) {
    EXPECT_NEAR(turned(kSight + 0.3), std::pow(4 * std::sin(0.3), 2), 1e-9);
    EXPECT_NEAR(turned(-kSight - 0.3), std::pow(4 * std::sin(0.3), 2), 1e-9);
    // At and beyond a right angle the nearest point is in the eyes.
    EXPECT_NEAR(turned(kSight + pi / 2 - 1e-9), 16, 1e-6);
    // Looking to the floor beside one's feet.
    EXPECT_NEAR(unseen({0, 1, 3}, {0, -1, 0}, {0, 1, 0}), std::pow(3 * std::sin(pi / 2 - kSight), 2), 1e-6);
}

TEST(Unseen, is_graded_where_the_cone_misses_the_screen) {
    EXPECT_NEAR(turned(kSight + pi / 2 + 0.2), 16 + kUnseen * 1.2, 1e-6);
    EXPECT_NEAR(turned(pi), 16 + kUnseen * (1 + pi / 2 - kSight), 1e-6);
    double last = 0;
    for (double angle = kSight + 0.01; angle < pi; angle += 0.01) {
        EXPECT_GE(turned(angle), last - 1e-9);
        last = turned(angle);
    }
}

// Three balls in a row on three joints; the first and the third are to be kept apart.
struct Balls {
    Body body;
    PosedBody posed;
    explicit Balls(const std::vector<dvec3>& places, double radius = 0.1) {
        body.joints.resize(places.size());
        for (std::size_t i = 0; i < places.size(); ++i) {
            body.joints[i].mass = 1;
            if (i > 0) body.joints[i].motion = JointMotion::axial({0, 1, 0}, -1, 1), body.joints[i].first = 5 + i;
            if (i > 0) body.joints[i].offset = places[i] - places[0];
            const auto index = static_cast<std::uint32_t>(i);
            body.spheres.push_back({index, {}, radius});
            body.capsules.push_back({index, index, index});
        }
        body.dofs = 5 + places.size();
        if (places.size() > 2) body.apart = {{0, 2}};
        std::vector<double> pose(body.dofs, 0);
        for (int i = 0; i < 3; ++i) pose[static_cast<std::size_t>(i)] = places[0][i];
        posed.pose(body, pose);
    }
};

// Centimetres to 3; those to 1.1 count twice.
TEST(LackOfMargin, is_steeper_where_nobody_stands_surely) {
    EXPECT_EQ(lackOfMargin(0.05), 0);
    EXPECT_NEAR(lackOfMargin(0.02), 1, 1e-12);
    EXPECT_NEAR(lackOfMargin(0.011), 1.9, 1e-12);
    EXPECT_NEAR(lackOfMargin(0.001), 2.9 + 1, 1e-12);
    EXPECT_NEAR(lackOfMargin(-0.1), 13 + 11.1, 1e-12);
}

TEST(Depth, in_itself_counts_the_pairs_to_keep_apart) {
    // 1: inside both. The first and the third are 17 cm apart with radii of 10: 30 mm deep.
    const Balls deep({{0, 1, 1}, {0.08, 1, 1}, {0.17, 1, 1}});
    EXPECT_NEAR(depthInItself(deep.body, deep.posed), 900, 1e-6);
    EXPECT_NEAR(deepestInItself(deep.body, deep.posed), 0.03, 1e-9);
    const Balls clear({{0, 1, 1}, {0.08, 1, 1}, {0.21, 1, 1}});
    EXPECT_EQ(depthInItself(clear.body, clear.posed), 0);
    EXPECT_EQ(deepestInItself(clear.body, clear.posed), 0);
}

TEST(Depth, in_others_sums_squares) {
    const Balls one({{0, 1, 1}, {1, 1, 1}}), other({{0, 1.19, 1}, {1, 1, 1.18}});
    EXPECT_NEAR(depthInOther(one.posed, other.posed), 100 + 400, 1e-6);
    EXPECT_NEAR(depthInOther(other.posed, one.posed), 100 + 400, 1e-6);
    EXPECT_NEAR(deepestInOther(one.posed, other.posed), 0.02, 1e-9);
    EXPECT_EQ(depthInOther(one.posed, Balls({{5, 1, 1}}).posed), 0);
}

TEST(Depth, in_the_stage_is_of_floor_and_screen) {
    EXPECT_NEAR(depthInStage({}, Balls({{0, 0.09, 1}}).posed), 100, 1e-6);
    EXPECT_NEAR(depthInStage({}, Balls({{0, 1, 0.08}}).posed), 400, 1e-6);
    EXPECT_NEAR(depthInStage({}, Balls({{0, -0.1, 1}}).posed), 40000, 1e-6);
    EXPECT_NEAR(deepestInStage({}, Balls({{0, 1, 0.08}, {1, 0.06, 1}}).posed), 0.04, 1e-9);
    EXPECT_EQ(depthInStage({}, Balls({{0, 0.1, 0.1}}).posed), 0);
    EXPECT_EQ(deepestInStage({}, Balls({{0, 5, 5}}).posed), 0);
    // Each further screen counts by itself.
    Stage stage;
    stage.screens.push_back({{2, 0}, radians(-90)});
    EXPECT_NEAR(depthInStage(stage, Balls({{1.92, 1, 1}}).posed), 400, 1e-6);
    EXPECT_NEAR(depthInStage(stage, Balls({{1.92, 1, 0.09}}).posed), 500, 1e-6);
    EXPECT_NEAR(deepestInStage(stage, Balls({{1.92, 1, 0.09}}).posed), 0.02, 1e-9);
    stage.screens[0].radius = 5;
    EXPECT_NEAR(depthInStage(stage, Balls({{-3 + 0.6 * 0.08, 1, 1 + 0.8 * 0.08}}).posed), 400, 1e-6);
}

TEST(OwnerChanges, are_counted_around_the_contour) {
    EXPECT_EQ(ownerChanges(std::vector<int>{}), 0);
    EXPECT_EQ(ownerChanges(std::vector{2}), 0);
    EXPECT_EQ(ownerChanges(std::vector{1, 1, 1}), 0);
    EXPECT_EQ(ownerChanges(std::vector{0, 0, 1, 1}), 2);
    EXPECT_EQ(ownerChanges(std::vector{0, 1, 1, 0}), 2);
    EXPECT_EQ(ownerChanges(std::vector{0, 1, 2}), 3);
    EXPECT_EQ(ownerChanges(std::vector{0, 1, 0, 1}), 4);
    // A prop's piece is nobody's burden: it neither ends one's own nor begins another.
    EXPECT_EQ(ownerChanges(std::vector{kNobody, kNobody}), 0);
    EXPECT_EQ(ownerChanges(std::vector{0, kNobody, 0, kNobody}), 0);
    EXPECT_EQ(ownerChanges(std::vector{kNobody, 0, kNobody, 1}), 2);
}

TEST(EnergyTerms, add_up_by_the_weights_of_the_table) {
    EnergyTerms terms;
    double* const all[] = {
        &terms.contourPoint, &terms.contourNormal, &terms.contourCurvature, &terms.coverage,   &terms.coherence, &terms.visible,
        &terms.floor,        &terms.supportArea,   &terms.margin,           &terms.people,     &terms.stageSet,  &terms.hint,
        &terms.smooth,       &terms.regular,       &terms.contactPlace,     &terms.contactTurn};
    PoseWeights weights{2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53};
    const double wanted[] = {2, 3, 5, 7, 11, 13, 34, 38, 46, 58, 62, 37, 41, 43, 47, 53};
    for (std::size_t i = 0; i < std::size(all); ++i) {
        *all[i] = 1;
        EXPECT_EQ(terms.total(weights, 2), wanted[i]) << i;
        *all[i] = 0;
    }
}

}  // namespace
}  // namespace fantascope::theatre
