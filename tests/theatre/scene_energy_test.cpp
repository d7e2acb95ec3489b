#include "theatre/scene_energy.h"

#include "theatre/energy_terms.h"

#include "a_scene.h"

#include <gmock/gmock.h>

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
    EXPECT_EQ(a.surroundings, b.surroundings);
}
std::span<const double> ofActor(const PoseProblem& problem, std::span<const double> freedoms, std::size_t actor) {
    std::size_t first = 0;
    for (std::size_t i = 0; i < actor; ++i) first += problem.actors[i].freedoms;
    return freedoms.subspan(first, problem.actors[actor].freedoms);
}

TEST(SceneEnergy, OfTheTargetsOwnPosesIsNothingInContourAndCoverage) {
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
    EXPECT_EQ(energy.shadow(), problem.target.mask);
    // Two people upright on the floor, apart, their arms out.
    EXPECT_NEAR(terms.floor, 0, 1e-6);
    EXPECT_NEAR(terms.people + terms.surroundings, 0, 1e-6);
    EXPECT_GT(energy.margin(0), 0.03);
    EXPECT_EQ(terms.margin, 0);
}

TEST(SceneEnergy, OneWhoMovesAloneGivesWhatPosingAllGives) {
    PoseProblem problem = aScene({1.7, 1.4, 1.8});
    const std::vector<double> start = aRow(problem, {-0.8, 0.1, 0.9}, 2);
    makeTarget(problem, start);
    SceneEnergy kept(problem);
    kept.pose(start);
    Rng rng(1);
    std::vector<double> poses = start;
    for (int i = 0; i < 12; ++i) {
        const std::size_t actor = rng.below(3);
        std::vector<double> moved = nudged(problem, poses, rng, 0.4);
        const auto own = ofActor(problem, moved, actor);
        std::copy(own.begin(), own.end(), poses.begin() + (ofActor(problem, poses, actor).data() - poses.data()));
        kept.pose(actor, own);
        SceneEnergy fresh(problem);
        fresh.pose(poses);
        expectSame(kept.terms(), fresh.terms());
        EXPECT_EQ(kept.shadow(), fresh.shadow());
        EXPECT_EQ(kept.energy(), fresh.energy());
    }
}

TEST(SceneEnergy, TermsOfTheLiftedAndOfTheSunken) {
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
    EXPECT_EQ(energy.terms().surroundings, 0);
    pose[1] -= 0.31;
    energy.pose(pose);
    EXPECT_EQ(energy.terms().floor, 0);
    EXPECT_GE(energy.terms().surroundings, 100 - 1e-6);  // one end at least, 10 mm deep
}

TEST(SceneEnergy, TwoInTheSamePlaceRunIntoEachOtherOnce) {
    PoseProblem problem = aScene({1.7, 1.7});
    const std::vector<double> apart = aRow(problem, {-1.5, 1.5}, 2), together = aRow(problem, {0, 0.1}, 2);
    makeTarget(problem, apart);
    SceneEnergy energy(problem);
    energy.pose(apart);
    EXPECT_EQ(energy.terms().people, 0);
    energy.pose(together);
    EXPECT_NEAR(energy.terms().people, depthInOther(energy.posed(0), energy.posed(1)), 1e-6);
    EXPECT_GT(energy.terms().people, 10000);
}

// Side by side each has a piece of the contour; where the second stands in the first's shadow, all is one's.
TEST(SceneEnergy, CoherenceCountsWhoseTheContourIs) {
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

TEST(SceneEnergy, WithoutAShadowAllIsMissed) {
    PoseProblem problem = aScene({1.7});
    std::vector<double> pose = aRow(problem, {0}, 2);
    makeTarget(problem, pose);
    SceneEnergy energy(problem);
    pose[0] = 500;
    energy.pose(pose);
    const EnergyTerms& terms = energy.terms();
    EXPECT_EQ(terms.coverage, 1);
    const double width = problem.target.mask.width() * problem.target.pixelsOf256;
    EXPECT_NEAR(terms.contourPoint, kContourPoints * width * width, 1e-3);
    EXPECT_TRUE(std::isfinite(energy.energy()));
    EXPECT_EQ(energy.shadow().count(), 0);
}

// A shadow a pixel to the side: every point of a contour is no farther than a pixel, those on upright edges a whole one.
TEST(SceneEnergy, ContourIsInPixelsOfATargetOf256) {
    PoseProblem problem = aScene({1.7});
    const std::vector<double> pose = aRow(problem, {0}, 2);
    makeTarget(problem, pose);
    BitMask shifted(problem.target.mask.width(), problem.target.mask.height());
    const BitMask shadow = problem.target.mask;
    for (int y = 0; y < shadow.height(); ++y)
        for (int x = 0; x < shadow.width(); ++x)
            if (shadow.at(x, y)) shifted.fill(y, x + 3, x + 4);
    setTarget(problem, shifted);
    SceneEnergy energy(problem);
    energy.pose(pose);
    const double scale = problem.target.pixelsOf256 * problem.target.pixelsOf256;
    EXPECT_EQ(scale, 4);
    EXPECT_LE(energy.terms().contourPoint, kContourPoints * 9 * scale);
    EXPECT_GE(energy.terms().contourPoint, 0.1 * kContourPoints * 9 * scale);
    EXPECT_NEAR(energy.terms().coverage, static_cast<double>(differing(shifted, shadow)) / static_cast<double>(shadow.count()),
                1e-12);
}

}  // namespace
}  // namespace fantascope::theatre
