#include "theatre/energy/scene_energy.h"

#include "theatre/a_scene.h"
#include "theatre/energy/energy_terms.h"

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

namespace fantascope::theatre {
namespace {

void expectSame(const EnergyTerms& a, const EnergyTerms& b) {
    EXPECT_EQ(a.contourPoint, b.contourPoint);
    EXPECT_EQ(a.contourNormal, b.contourNormal);
    EXPECT_EQ(a.contourCurvature, b.contourCurvature);
    EXPECT_EQ(a.coverage, b.coverage);
    EXPECT_EQ(a.coherence, b.coherence);
    EXPECT_EQ(a.visible, b.visible);
    EXPECT_EQ(a.floor, b.floor);
    EXPECT_EQ(a.supportArea, b.supportArea);
    EXPECT_EQ(a.margin, b.margin);
    EXPECT_EQ(a.people, b.people);
    EXPECT_EQ(a.stageSet, b.stageSet);
}
void expectSameContour(const SceneEnergy& a, const SceneEnergy& b) {
    for (std::size_t i = 0; i < a.nearest().size(); ++i) {
        EXPECT_EQ(a.nearest()[i].pixel, b.nearest()[i].pixel) << i;
        EXPECT_EQ(a.nearest()[i].normal, b.nearest()[i].normal) << i;
        EXPECT_EQ(a.nearest()[i].curvature, b.nearest()[i].curvature) << i;
        EXPECT_EQ(a.owners()[i], b.owners()[i]) << i;
    }
}

TEST(SceneEnergy, is_nothing_in_contour_and_coverage_for_the_poses_of_the_target) {
    PoseProblem problem = aScene({1.7, 1.4});
    const std::vector<double> poses = aRow(problem, {-0.6, 0.6}, 2);
    makeTarget(problem, poses);
    SceneEnergy energy(problem);
    energy.pose(poses);
    const EnergyTerms& terms = energy.terms();
    EXPECT_EQ(terms.contourPoint, 0);
    EXPECT_EQ(terms.contourNormal, 0);
    EXPECT_EQ(terms.contourCurvature, 0);
    EXPECT_EQ(terms.coverage, 0);
    EXPECT_EQ(energy.shadow(), problem.targets[0].mask);
    // Two people upright on the floor, apart, their arms out.
    EXPECT_NEAR(terms.floor, 0, 1e-6);
    EXPECT_NEAR(terms.people + terms.stageSet, 0, 1e-6);
    EXPECT_GT(energy.margin(0), 0.03);
    EXPECT_EQ(terms.margin, 0);
}

TEST(SceneEnergy, is_the_same_whether_one_is_posed_or_all) {
    PoseProblem problem = aScene({1.7, 1.4, 1.8});
    const std::vector<double> start = aRow(problem, {-0.8, 0.1, 0.9}, 2);
    makeTarget(problem, start);
    SceneEnergy kept(problem);
    kept.pose(start);
    Rng rng(1);
    std::vector<double> poses = start;
    for (int i = 0; i < 60; ++i) {
        const std::size_t actor = rng.below(3), first = problem.firstDof(actor), count = problem.actors[actor].dofs;
        // All of somebody, or one joint's degree of freedom, which leaves most of the contour as it
        // was.
        const std::vector<double> moved = nudged(problem, poses, rng, 0.4);
        const std::size_t one = first + Body::kRootDofs + rng.below(static_cast<std::uint32_t>(count - Body::kRootDofs));
        const std::size_t from = i % 3 == 0 ? first : one, to = i % 3 == 0 ? first + count : one + 1;
        for (std::size_t k = from; k < to; ++k) poses[k] = moved[k];
        const auto own = std::span(poses).subspan(first, count);
        problem.actors[actor].limit(own);
        kept.pose(actor, own);
        SceneEnergy fresh(problem);
        fresh.pose(poses);
        expectSame(kept.terms(), fresh.terms());
        EXPECT_EQ(kept.shadow(), fresh.shadow());
        EXPECT_EQ(kept.energy(), fresh.energy());
        expectSameContour(kept, fresh);
    }
}

TEST(SceneEnergy, charges_who_is_lifted_and_who_has_sunk) {
    PoseProblem problem = aScene({1.7});
    std::vector<double> pose = aRow(problem, {0}, 2);
    makeTarget(problem, pose);
    SceneEnergy energy(problem);
    energy.pose(pose);
    const double margin = energy.margin(0);
    // 30 cm up: but for the height he stands as before.
    pose[1] += 0.3;
    energy.pose(pose);
    EXPECT_NEAR(energy.terms().floor, 300, 1e-6);
    EXPECT_NEAR(energy.margin(0), margin, 1e-9);
    EXPECT_EQ(energy.terms().stageSet, 0);
    pose[1] -= 0.31;
    energy.pose(pose);
    EXPECT_EQ(energy.terms().floor, 0);
    EXPECT_NEAR(energy.terms().stageSet, 600, 1e-6) << "a heel and two toes of each foot, 10 mm deep";
}

// By hand: fingers end at .538 of the stature, 1.7 m. Those of two in T-poses are 1 cm in each
// other, and nothing else is.
TEST(SceneEnergy, charges_two_who_meet_once) {
    PoseProblem problem = aScene({1.7, 1.7});
    const double reach = 2 * 0.538 * 1.7;
    const std::vector<double> apart = aRow(problem, {0, reach + 1e-6}, 2), meeting = aRow(problem, {0, reach - 0.01}, 2),
                              together = aRow(problem, {0, 0.1}, 2);
    makeTarget(problem, apart);
    SceneEnergy energy(problem);
    energy.pose(apart);
    EXPECT_EQ(energy.terms().people, 0);
    energy.pose(meeting);
    EXPECT_NEAR(energy.terms().people, 100, 1e-3) << "square millimetres";
    energy.pose(together);
    EXPECT_GT(energy.terms().people, 10000);
}

// Side by side each has a piece of the contour; where the second stands in the first's shadow, all
// is one's.
TEST(SceneEnergy, counts_for_coherence_whose_the_contour_is) {
    PoseProblem problem = aScene({1.7, 1.7});
    const std::vector<double> side = aRow(problem, {-0.9, 0.9}, 2), one = aRow(problem, {0, 0}, 2);
    makeTarget(problem, side);
    SceneEnergy energy(problem);
    energy.pose(side);
    // The target is the larger of two islands if they do not meet; hands that meet make one.
    const auto owners = energy.terms().coherence;
    EXPECT_GE(owners, 2);
    EXPECT_LE(owners, 4);
    EXPECT_EQ(owners, ownerChanges(energy.owners()));
    for (std::size_t i = 0; i < kContourPoints; ++i) {
        const ContourPoint& point = energy.nearest()[i];
        EXPECT_TRUE(energy.shadow(static_cast<std::size_t>(energy.owners()[i])).at(point.pixel.x, point.pixel.y));
    }
    energy.pose(one);
    EXPECT_EQ(energy.terms().coherence, 0);
}

// The masks end somewhere, and the wall does not: whoever steps out of the picture is as much too
// much as he was in it. Example failure: an actor whom the silhouette does not need, and whose
// elbow is seen beside it.
TEST(SceneEnergy, charges_shadows_beside_the_picture) {
    PoseProblem narrow = aScene({1.7, 1.7});
    const std::vector<double> both = aRow(narrow, {-0.8, 0.8}, 2);
    makeTarget(narrow, both);
    PoseProblem wide = narrow;
    const ScreenFrame& frame = narrow.targets[0].frame;
    const int more = 400;
    const glm::dvec2 corner = frame.metresAt({-more, 0});
    wide.targets[0].frame = {narrow.stage, corner.x, corner.y, frame.pixel(), frame.width() + 2 * more, frame.height()};
    wide.targets[0].mask = BitMask(frame.width() + 2 * more, frame.height());
    SceneEnergy seen(wide);
    seen.pose(both);
    seen.terms();
    setTarget(wide, seen.shadow());
    for (const double x : {0.8, 2.2, 3.1, 4.5}) {
        std::vector<double> poses = aRow(narrow, {-0.8, x}, 2);
        SceneEnergy in(narrow), all(wide);
        in.pose(poses), all.pose(poses);
        const double far = std::max(0.0, x - 3);
        EXPECT_NEAR(in.terms().coverage, all.terms().coverage, 0.2 + 0.3 * far) << x;
        EXPECT_GE(in.terms().coverage, 0.9 * all.terms().coverage) << x;
        EXPECT_EQ(in.beam(0).beyond() > 0, x > 1) << x;
    }
    narrow.stage.beams[0].lit = Stage::Area{{-3, 0}, {3, 3}};
    SceneEnergy dark(narrow);
    dark.pose(aRow(narrow, {-0.8, 4.5}, 2));
    dark.terms();
    EXPECT_EQ(dark.beam(0).beyond(), 0) << "a projector's picture ends before";
}

TEST(SceneEnergy, misses_all_of_the_target_without_a_shadow) {
    PoseProblem problem = aScene({1.7});
    std::vector<double> pose = aRow(problem, {0}, 2);
    makeTarget(problem, pose);
    SceneEnergy energy(problem);
    pose[0] = 500;
    energy.pose(pose);
    const EnergyTerms& terms = energy.terms();
    EXPECT_DOUBLE_EQ(terms.coverage, 1 + energy.beam(0).beyond() / problem.targets[0].area) << "and he is too much where he is";
    const double width = problem.targets[0].mask.width() * problem.targets[0].refPixelsPerPixel;
    EXPECT_NEAR(terms.contourPoint, kContourPoints * width * width, 1e-3);
    EXPECT_TRUE(std::isfinite(energy.energy()));
    EXPECT_EQ(energy.shadow().count(), 0);
    // What was not there is looked for anew.
    pose[0] = 0;
    energy.pose(pose);
    energy.terms();
    SceneEnergy fresh(problem);
    fresh.pose(pose);
    expectSame(energy.terms(), fresh.terms());
    expectSameContour(energy, fresh);
}

// A shadow a pixel to the side: every point of a contour is no farther than a pixel, those on
// upright edges a whole one.
TEST(SceneEnergy, measures_the_contour_in_pixels_of_a_target_of_256) {
    PoseProblem problem = aScene({1.7});
    const std::vector<double> pose = aRow(problem, {0}, 2);
    makeTarget(problem, pose);
    BitMask shifted(problem.targets[0].mask.width(), problem.targets[0].mask.height());
    const BitMask shadow = problem.targets[0].mask;
    for (int y = 0; y < shadow.height(); ++y)
        for (int x = 0; x < shadow.width(); ++x)
            if (shadow.at(x, y)) shifted.fill(y, x + 3, x + 4);
    setTarget(problem, shifted);
    SceneEnergy energy(problem);
    energy.pose(pose);
    const double scale = problem.targets[0].refPixelsPerPixel * problem.targets[0].refPixelsPerPixel;
    EXPECT_EQ(scale, 4);
    EXPECT_LE(energy.terms().contourPoint, kContourPoints * 9 * scale);
    EXPECT_GE(energy.terms().contourPoint, 0.1 * kContourPoints * 9 * scale);
    EXPECT_NEAR(energy.terms().coverage, static_cast<double>(differing(shifted, shadow)) / static_cast<double>(shadow.count()),
                1e-12);
}

TEST(SceneEnergy, lets_people_stand_on_a_platform_as_on_the_floor) {
    PoseProblem problem = aScene({1.7});
    std::vector<double> pose = aRow(problem, {0}, 2);
    makeTarget(problem, pose);
    const double margin = [&] {
        SceneEnergy energy(problem);
        energy.pose(pose);
        return energy.margin(0);
    }();
    problem.stage.platforms = {{"block", {0, 0.2, 2}, {1, 0.4, 1}, 0}};
    SceneEnergy energy(problem);
    pose[1] += 0.4;
    energy.pose(pose);
    EXPECT_NEAR(energy.terms().floor, 0, 1e-6);
    EXPECT_NEAR(energy.terms().stageSet, 0, 1e-6);
    EXPECT_NEAR(energy.margin(0), margin, 1e-9);
    // 5 cm above the top; then 40 cm above the floor, beside it.
    pose[1] += 0.05;
    energy.pose(pose);
    EXPECT_NEAR(energy.terms().floor, 50, 1e-6);
    pose[0] += 2, pose[1] -= 0.05;
    energy.pose(pose);
    EXPECT_NEAR(energy.terms().floor, 400, 1e-6);
    // On the floor, in the block.
    pose[0] -= 2, pose[1] -= 0.4;
    energy.pose(pose);
    EXPECT_GT(energy.terms().stageSet, 1e4);
}

// By hand: the light at z = 7, a wall 40 x 180 x 20 cm that stands with its middle at x = 1, z = 2.
// Its left edge is thrown by the back, 1.9 m from the screen, its right one and its top by the
// front: .8 * 7 / 5.1, 1.2 * 7 / 4.9 and .1 + 1.7 * 7 / 4.9. The hand of one behind it is in its
// shadow.
TEST(SceneEnergy, has_shadows_of_props_that_are_nobodys) {
    PoseProblem problem = aScene({1.7});
    const std::vector<double> pose = aRow(problem, {-0.15}, 2.6);
    problem.stage.props = {aBox({0.4, 1.8, 0.2}, {1, 0.9, 2})};
    makeTarget(problem, pose);
    SceneEnergy energy(problem);
    energy.pose(pose);
    EXPECT_EQ(energy.terms().coverage, 0) << "the prop's shadow is there before the actor's";
    const ScreenFrame& frame = problem.targets[0].frame;
    const auto isDark = [&](double x, double y) {
        const glm::dvec2 pixel = frame.pixelAt(x, y);
        return energy.shadow().at(static_cast<int>(std::floor(pixel.x)), static_cast<int>(std::floor(pixel.y)));
    };
    const double left = 0.8 * 7 / 5.1, right = 1.2 * 7 / 4.9, top = 0.1 + 1.7 * 7 / 4.9, e = 0.6 * frame.pixel();
    EXPECT_TRUE(isDark(left + e, 1));
    EXPECT_FALSE(isDark(left - e, 1));
    EXPECT_TRUE(isDark(right - e, 1));
    EXPECT_FALSE(isDark(right + e, 1));
    EXPECT_TRUE(isDark(1.4, top - e));
    EXPECT_FALSE(isDark(1.4, top + e));
    EXPECT_GT(std::count(energy.owners().begin(), energy.owners().end(), kNobody), 20);
    EXPECT_GT(std::count(energy.owners().begin(), energy.owners().end(), 0), 20);
    EXPECT_EQ(energy.terms().coherence, 0) << "all that is somebody's is one's";
    EXPECT_NEAR(energy.terms().stageSet, 0, 1e-6);
}

// A turned platform's is that of the same box as a prop.
TEST(SceneEnergy, has_shadows_of_platforms_too) {
    PoseProblem problem = aScene({1.7});
    const std::vector<double> pose = aRow(problem, {-0.9}, 3);
    makeTarget(problem, pose);
    const auto shadow = [&](const Stage& stage) {
        problem.stage = stage;
        SceneEnergy energy(problem);
        energy.pose(pose);
        energy.terms();
        return energy.shadow();
    };
    Stage withPlatform = problem.stage, withProp = problem.stage;
    withPlatform.platforms = {{"block", {1, 0.5, 2}, {1, 1, 0.2}, radians(40)}};
    withProp.props = {aBox({1, 1, 0.2}, {1, 0.5, 2})};
    withProp.props[0].turn = rotationOf({0, radians(40), 0});
    const BitMask bare = shadow(problem.stage), platform = shadow(withPlatform), prop = shadow(withProp);
    EXPECT_LE(differing(platform, prop), 4);
    EXPECT_GT(differing(platform, bare), 1000);
}

// A box in the left hand of one who looks at the screen goes with it.
TEST(SceneEnergy, moves_what_is_held_with_the_hand) {
    PoseProblem problem = aScene({2.0, 2.0});
    std::vector<double> poses = aRow(problem, {-0.9, 1.9}, 2);
    makeTarget(problem, poses);
    Prop box = aBox({0.2, 0.2, 0.2}, {0.3, 0.1, 0});
    box.holder = Prop::Holder{0, BodyPart::LeftHand};
    problem.stage.props = {box};
    SceneEnergy energy(problem);
    energy.pose(poses);
    ASSERT_EQ(energy.held(0).size(), 1u);
    EXPECT_TRUE(energy.held(1).empty());
    // The hand is at 1.076 m on his left, which is -x now, 1.6224 up and .006 behind.
    EXPECT_LT(glm::distance(energy.held(0)[0].place, {-0.9 - 1.376, 1.7224, 2.006}), 1e-6);
    const BitMask before = energy.shadow();
    EXPECT_GT(energy.terms().coverage, 0) << "the target is without the box";
    // Turned about: on the other side. The mask does not show what was.
    poses[4] = 0;
    energy.pose(0, std::span(poses).first(problem.actors[0].dofs));
    energy.terms();
    EXPECT_LT(glm::distance(energy.held(0)[0].place, {-0.9 + 1.376, 1.7224, 1.994}), 1e-6);
    SceneEnergy fresh(problem);
    fresh.pose(poses);
    fresh.terms();
    EXPECT_EQ(energy.shadow(), fresh.shadow());
    EXPECT_EQ(energy.terms().stageSet, fresh.terms().stageSet);
    EXPECT_FALSE(energy.shadow() == before);
    // Where the other's arm is it is in the way.
    EXPECT_NEAR(energy.terms().stageSet, 0, 1e-6);
    poses[0] += 0.7, poses[1] -= 0.1;
    energy.pose(poses);
    std::vector<Intrusion> intrusions;
    findIntrusions(problem.actors[1], energy.posed(1), energy.held(0), intrusions);
    ASSERT_FALSE(intrusions.empty());
    EXPECT_GE(energy.terms().stageSet, squaredDepths(intrusions));
}

TEST(SceneEnergy, has_no_shadow_where_a_projector_does_not_light) {
    PoseProblem problem = aScene({1.7});
    const std::vector<double> pose = aRow(problem, {0}, 2);
    makeTarget(problem, pose);
    const BitMask whole = problem.targets[0].mask;
    problem.stage.beams[0].lit = Stage::Area{{-0.4, 0.2}, {3, 1.5}};
    SceneEnergy energy(problem);
    energy.pose(pose);
    energy.terms();
    int kept = 0;
    for (int y = 0; y < whole.height(); ++y)
        for (int x = 0; x < whole.width(); ++x) {
            const glm::dvec2 at = problem.targets[0].frame.metresAt({x + 0.5, y + 0.5});
            const bool isLit = at.x > -0.4 && at.y > 0.2 && at.y < 1.5;
            ASSERT_EQ(energy.shadow().at(x, y), whole.at(x, y) && isLit) << x << ", " << y;
            kept += energy.shadow().at(x, y);
        }
    EXPECT_GT(kept, 500);
}

// One with his feet at z = 2, his toes at 2 - .0998 * 1.7: that far outside, in millimetres
// squared.
TEST(SceneEnergy, charges_who_stands_where_nobody_may) {
    PoseProblem problem = aScene({1.7});
    const std::vector<double> pose = aRow(problem, {0}, 2);
    makeTarget(problem, pose);
    problem.stage.standing = Stage::Area{{-1, 2.2}, {1, 4}};
    SceneEnergy energy(problem);
    energy.pose(pose);
    const double outside = 2.2 - (2 - 0.0998 * 1.7);
    EXPECT_NEAR(energy.outside(0), outside, 0.002);
    EXPECT_NEAR(energy.terms().stageSet, 1e6 * energy.outside(0) * energy.outside(0), 1e-6);
    problem.stage.standing = Stage::Area{{-1, 1}, {1, 4}};
    energy.pose(pose);
    EXPECT_NEAR(energy.terms().stageSet, 0, 1e-6);
}

}  // namespace
}  // namespace fantascope::theatre
