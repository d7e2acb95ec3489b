#include "theatre/search/silhouette_fit.h"

#include "theatre/a_scene.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fantascope::theatre {
namespace {

// Two people side by side whose arms and legs are a little bent: their shadow is the target.
struct Scene {
    PoseProblem problem = aScene({1.7, 1.5});
    std::vector<double> wanted;
    Scene() {
        wanted = aRow(problem, {-0.75, 0.75}, 2);
        std::size_t first = 0;
        for (const Body& body : problem.actors) {
            for (const char* joint : {"left elbow", "right elbow"}) wanted[first + body.joints[body.joint(joint)].first] += 0.4;
            wanted[first + body.joints[body.joint("right shoulder")].first] += 0.3;
            first += body.dofs;
        }
        makeTarget(problem, wanted);
    }
    double energyOf(const std::vector<double>& poses) const {
        SceneEnergy energy(problem);
        energy.pose(poses);
        return energy.energy();
    }
};

TEST(SilhouetteFit, returns_most_of_the_way_from_a_nudge) {
    const Scene scene;
    const double least = scene.energyOf(scene.wanted);
    Rng rng(1);
    for (int trial = 0; trial < 4; ++trial) {
        std::vector<double> poses = nudged(scene.problem, scene.wanted, rng, 0.05);
        const double before = scene.energyOf(poses);
        SceneEnergy energy(scene.problem);
        SilhouetteFit fit(scene.problem);
        const double after = fit.run(energy, poses, 60);
        EXPECT_LT(after - least, 0.2 * (before - least)) << before << ", " << least;
        EXPECT_EQ(after, scene.energyOf(poses));
    }
}

// What it promises: the first step that is tried from a nudge goes downhill, since it is short
// enough.
TEST(SilhouetteFit, goes_downhill) {
    const Scene scene;
    Rng rng(2);
    int lower = 0;
    for (int trial = 0; trial < 10; ++trial) {
        std::vector<double> poses = nudged(scene.problem, scene.wanted, rng, 0.04);
        const double before = scene.energyOf(poses);
        SceneEnergy energy(scene.problem);
        lower += SilhouetteFit(scene.problem).run(energy, poses, 3) < before;
    }
    EXPECT_GE(lower, 9);
}

// A limb that reaches beyond the light has no outline, and a negative radius if it is divided by
// its depth all the same.
TEST(SilhouetteFit, bears_who_reaches_beyond_the_light) {
    PoseProblem problem = aScene({1.7, 1.7});
    std::vector<double> poses = aRow(problem, {-1, 1}, 2);
    makeTarget(problem, poses);
    const Body& body = problem.actors[0];
    for (const double turn : {0.5, -0.5}) {  // an arm to the light, the other to the screen
        const std::vector<double> reaching =
            body.restPose({0, body.joints[0].offset.y, 6.6}, rotationOf({0, turn * std::numbers::pi, 0}));
        std::copy(reaching.begin(), reaching.end(), poses.begin());
        SceneEnergy energy(problem);
        energy.pose(poses);
        const double before = energy.energy();
        const auto depthOf = [&](const char* joint) { return energy.posed(0).place(body.joint(joint)).z; };
        ASSERT_GT(std::max(depthOf("left wrist"), depthOf("right wrist")), problem.stage.beams[0].light.z);
        EXPECT_LE(SilhouetteFit(problem).run(energy, poses, 10), before);
        for (const double dof : poses) EXPECT_TRUE(std::isfinite(dof));
    }
}

TEST(SilhouetteFit, never_raises_the_energy_and_stays_within_the_limits) {
    const Scene scene;
    Rng rng(3);
    for (int trial = 0; trial < 6; ++trial) {
        // From far away as well.
        std::vector<double> poses = nudged(scene.problem, scene.wanted, rng, 0.3 * trial);
        const double before = scene.energyOf(poses);
        SceneEnergy energy(scene.problem);
        const double after = SilhouetteFit(scene.problem).run(energy, poses, 15);
        EXPECT_LE(after, before);
        EXPECT_EQ(after, scene.energyOf(poses));
        EXPECT_EQ(energy.terms().total(scene.problem.weights), after);  // left posed so
        std::vector<double> limited = poses;
        std::span<double> rest(limited);
        for (const Body& body : scene.problem.actors) body.limit(rest.first(body.dofs)), rest = rest.subspan(body.dofs);
        EXPECT_THAT(limited, testing::Pointwise(testing::DoubleNear(1e-12), poses));
    }
}

TEST(SilhouetteFit, moves_what_may_move) {
    const Scene scene;
    Rng rng(4);
    const std::vector<double> start = nudged(scene.problem, scene.wanted, rng, 0.05);
    std::vector<double> poses = start;
    std::vector<char> moves(start.size(), 0);
    const std::size_t first = scene.problem.actors[0].dofs;
    for (std::size_t i = first; i < moves.size(); ++i) moves[i] = i % 2;
    SceneEnergy energy(scene.problem);
    const double before = scene.energyOf(start);
    EXPECT_LT(SilhouetteFit(scene.problem).run(energy, poses, 20, 1, moves), before);
    int moved = 0;
    for (std::size_t i = 0; i < moves.size(); ++i) {
        // A ball or cone that is full gives way as a whole; nothing of the first actor moves.
        EXPECT_TRUE(i >= first || poses[i] == start[i]) << i;
        moved += poses[i] != start[i];
    }
    EXPECT_GT(moved, 5);
    const std::vector<char> none(start.size(), 0);
    poses = start;
    EXPECT_EQ(SilhouetteFit(scene.problem).run(energy, poses, 5, 1, none), before);
    EXPECT_EQ(poses, start);
}

TEST(SilhouetteFit, gives_the_same_twice_and_counts_its_evaluations) {
    const Scene scene;
    Rng rng(5);
    const std::vector<double> start = nudged(scene.problem, scene.wanted, rng, 0.1),
                              other = nudged(scene.problem, scene.wanted, rng, 0.1);
    std::vector<double> once = start, again = start, between = other;
    SceneEnergy energy(scene.problem), fresh(scene.problem);
    SilhouetteFit fit(scene.problem), freshFit(scene.problem);
    fit.run(energy, once, 8);
    EXPECT_GT(fit.evaluations(), 1);
    EXPECT_LE(fit.evaluations(), 9);
    freshFit.run(fresh, between, 8);  // what was before leaves no trace
    freshFit.run(fresh, again, 8);
    EXPECT_EQ(once, again);
}

// Each term of physics alone is a way downhill: nothing but it is weighed.
TEST(SilhouetteFit, mends_what_physics_forbids) {
    const auto share = [](double PoseWeights::*weight, std::vector<double> poses, PoseProblem& problem) {
        problem.weights = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
        problem.weights.*weight = 1;
        SceneEnergy energy(problem);
        energy.pose(poses);
        const double before = energy.energy();
        EXPECT_GT(before, 1);
        return SilhouetteFit(problem).run(energy, poses, 40) / before;
    };
    Scene scene;
    std::vector<double> close = aRow(scene.problem, {-0.65, 0.65}, 2);
    // The shorter lifted to the other's height and a little behind: hands in each other, their
    // middles 4 cm apart.
    close[scene.problem.actors[0].dofs + 1] += 0.2 * 0.812;
    close[scene.problem.actors[0].dofs + 2] -= 0.04;
    EXPECT_LT(share(&PoseWeights::w10, close, scene.problem), 0.01) << "people";
    std::vector<double> moved = scene.wanted;
    moved[1] -= 0.05;
    EXPECT_LT(share(&PoseWeights::w11, moved, scene.problem), 0.01) << "floor";
    EXPECT_LT(share(&PoseWeights::w11, aRow(scene.problem, {-0.75, 0.75}, 0.05), scene.problem), 0.01) << "screen";
    moved[1] += 0.15;
    EXPECT_LT(share(&PoseWeights::w7, moved, scene.problem), 0.05) << "height";
    moved = scene.wanted;
    const Body& body = scene.problem.actors[0];
    moved[body.joints[body.joint("lumbar")].first] -= 0.36;
    moved[body.joints[body.joint("thorax")].first] -= 0.33;
    // Feet that are let go of leave no way: less is asked.
    EXPECT_LT(share(&PoseWeights::w9, moved, scene.problem), 0.7) << "balance";
}

// The same of what stands on a stage, and of what others hold.
TEST(SilhouetteFit, leaves_what_stands_on_the_stage) {
    const auto share = [](std::vector<double> poses, const PoseProblem& given, double PoseWeights::*weight = &PoseWeights::w11) {
        PoseProblem problem = given;
        problem.weights = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
        problem.weights.*weight = 1;
        SceneEnergy energy(problem);
        energy.pose(poses);
        const double before = energy.energy();
        EXPECT_GT(before, 100);
        return SilhouetteFit(problem).run(energy, poses, 40) / before;
    };
    Scene scene;
    const auto poses = scene.wanted;
    const Stage bare = scene.problem.stage;
    const auto with = [&](auto change) {
        scene.problem.stage = bare;
        change(scene.problem.stage);
        return scene.problem;
    };
    // Its right side is 5 cm in the middle of the first one's left leg.
    EXPECT_LT(share(poses, with([](Stage& stage) {
                        stage.platforms = {{"block", {-0.45, 0.15, 2}, {0.4, 0.3, 0.6}, 0}};
                    })),
              0.01)
        << "platform";
    EXPECT_LT(share(poses, with([](Stage& stage) { stage.props = {aBox({0.4, 0.3, 0.6}, {-0.45, 0.15, 2})}; })), 0.01) << "prop";
    EXPECT_LT(share(poses, with([](Stage& stage) { stage.standing = Stage::Area{{-5, 0}, {5, 1.8}}; })), 0.01) << "area";
    // In the second's hand is a box whose bottom is 1 cm below the tips of the first one's fingers;
    // either may go.
    scene.problem.stage = bare;
    SceneEnergy energy(scene.problem);
    energy.pose(poses);
    const auto partOf = [&](std::size_t actor, BodyPart part) {
        return scene.problem.actors[actor].parts[static_cast<std::size_t>(part)];
    };
    const Body::Point hand = partOf(1, BodyPart::LeftHand);
    const glm::dvec3 tips = energy.posed(0).point(partOf(0, BodyPart::RightHand));
    Prop box = aBox({0.2, 0.2, 0.2}, {});
    box.holder = Prop::Holder{1, BodyPart::LeftHand};
    box.turn = glm::conjugate(energy.posed(1).turn(hand.joint));
    box.place = box.turn * (tips + glm::dvec3(0, 0.09, 0) - energy.posed(1).point(hand));
    EXPECT_LT(share(poses, with([&](Stage& stage) { stage.props = {box}; })), 0.05) << "held by another";
    // A staff from the first's hand down through the floor.
    EXPECT_LT(share(poses, with([](Stage& stage) {
                        Prop staff = aBox({0.03, 3, 0.03}, {0, 0, 0});
                        staff.holder = Prop::Holder{0, BodyPart::LeftHand};
                        stage.props = {staff};
                    })),
              0.05)
        << "held into the floor";
    // 10 cm above a platform.
    std::vector<double> high = aRow(scene.problem, {-0.75, 0.75}, 2);
    for (const std::size_t first : {std::size_t{0}, scene.problem.actors[0].dofs}) high[first + 1] += 0.5;
    EXPECT_LT(share(high, with([](Stage& stage) {
                        stage.platforms = {{"block", {0, 0.2, 2}, {4, 0.4, 2}, 0}};
                    }),
                    &PoseWeights::w7),
              0.1)
        << "height above a platform";
}

}  // namespace
}  // namespace fantascope::theatre
