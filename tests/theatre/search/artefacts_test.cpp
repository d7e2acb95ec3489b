#include "theatre/search/artefacts.h"

#include "theatre/a_scene.h"
#include "theatre/masks.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <numeric>

namespace fantascope::theatre {
namespace {

using testing::ElementsAreArray;
using testing::IsEmpty;

PoseTarget aBlock() {
    PoseProblem problem = aScene({1.7});
    setTarget(problem, drawn(360, 170, [](int x, int y) { return x >= 100 && x < 200 && y >= 50 && y < 150; }));
    return problem.targets[0];
}

// The easy wrong version counts every pixel that differs, and there always are some along the
// outline.
TEST(VisibleArtefacts, are_wide_and_not_only_long) {
    const PoseTarget target = aBlock();  // of pixels of 2
    const auto shadow = [&](auto differs) {
        return drawn(360, 170, [&](int x, int y) { return target.mask.at(x, y) != differs(x, y); });
    };
    EXPECT_EQ(visibleArtefacts(target, target.mask).count(), 0);
    const BitMask thin = shadow([](int x, int) { return x >= 197 && x < 203; });  // 3 pixels of the target's, 3 beyond it
    const BitMask narrow = shadow([](int x, int y) { return x >= 140 && x < 143 && y >= 60 && y < 140; });
    EXPECT_EQ(visibleArtefacts(target, narrow).count(), 0);
    EXPECT_GT(visibleArtefacts(target, thin).count(), 0) << "6 pixels of 2 are wider than 8 of 1";

    const BitMask hole = shadow([](int x, int y) { return x >= 140 && x < 160 && y >= 80 && y < 100; });
    const BitMask found = visibleArtefacts(target, hole);
    EXPECT_NEAR(static_cast<double>(found.count()), 400, 25) << "all of it but its corners";
    EXPECT_TRUE(found.at(150, 90));
    EXPECT_FALSE(found.at(150, 120));
    const BitMask spur = shadow([](int x, int y) { return x >= 200 && x < 220 && y >= 80 && y < 90; });
    EXPECT_TRUE(visibleArtefacts(target, spur).at(210, 85));
}

// All degrees of freedom of these joints, the actors' one after the other.
Dofs dofsOf(const PoseProblem& problem, std::size_t actor, const std::vector<std::string_view>& joints) {
    std::size_t first = 0;
    for (std::size_t i = 0; i < actor; ++i) first += problem.actors[i].dofs;
    const Body& body = problem.actors[actor];
    Dofs dofs;
    for (const std::string_view name : joints) {
        const Body::Joint& joint = body.joints[body.joint(name)];
        for (std::size_t k = 0; k < joint.motion.size(); ++k) dofs.push_back(first + joint.first + k);
    }
    std::sort(dofs.begin(), dofs.end());
    return dofs;
}
Dofs allOf(const std::vector<Dofs>& chains) {
    Dofs all;
    for (const Dofs& chain : chains) all.insert(all.end(), chain.begin(), chain.end());
    std::sort(all.begin(), all.end());
    return all;
}
struct Scene {
    Scene(const PoseProblem& given, const std::vector<double>& poses) : problem(withTarget(given)), energy(problem) {
        energy.pose(poses);
        energy.terms();
    }
    static PoseProblem withTarget(PoseProblem problem) {
        setTarget(problem, drawn(360, 170, [](int x, int) { return x < 10; }));
        return problem;
    }
    PoseProblem problem;
    SceneEnergy energy;
};

TEST(OccludedChains, nobody_alone_with_his_arms_out_has_one) {
    const PoseProblem problem = aScene({1.7});
    Scene scene(problem, aRow(problem, {0}, 2));
    EXPECT_THAT(occludedChains(scene.problem, scene.energy), IsEmpty());
}

TEST(OccludedChains, who_is_behind_a_board_is_free_whole_but_for_his_place) {
    for (const std::size_t hidden : {std::size_t{0}, std::size_t{1}}) {
        PoseProblem problem = aScene({1.7, 1.7});
        const std::vector<double> poses = aRow(problem, {-1.2, 1.2}, 2);
        problem.stage.props.push_back(aBox({2, 2, 0.01}, {hidden == 0 ? -1.1 : 1.1, 0.9, 2.4}));
        Scene scene(problem, poses);
        Dofs wanted(problem.actors[hidden].dofs - Body::kRootDofs);
        std::iota(wanted.begin(), wanted.end(), hidden * problem.actors[0].dofs + Body::kRootDofs);
        EXPECT_THAT(allOf(occludedChains(scene.problem, scene.energy)), ElementsAreArray(wanted)) << hidden;
    }
}

// The easy wrong version frees both of two that hide nobody but each other, and the shadow is gone.
TEST(OccludedChains, of_two_that_hide_each_other_one_stays) {
    const PoseProblem problem = aScene({1.7, 1.7});
    Scene scene(problem, aRow(problem, {0, 0}, 2));
    const std::vector<Dofs> chains = occludedChains(scene.problem, scene.energy);
    ASSERT_FALSE(chains.empty());
    for (const Dofs& chain : chains)
        for (const std::size_t dof : chain) EXPECT_LT(dof, problem.actors[0].dofs);
}

TEST(OccludedChains, begin_at_the_ends_and_props_hide_them_too) {
    PoseProblem problem = aScene({1.7});
    const std::vector<double> poses = aRow(problem, {0}, 2);
    PosedBody posed;
    posed.pose(problem.actors[0], poses);
    // A board before a hand and its forearm, but not before the upper arm.
    const glm::dvec3 elbow = posed.place(problem.actors[0].joint("left elbow"));
    const double side = elbow.x > 0 ? 1 : -1;
    problem.stage.props.push_back(aBox({1, 0.6, 0.01}, {elbow.x + side * 0.45, elbow.y, 2.4}));
    Scene scene(problem, poses);
    const auto chains = occludedChains(scene.problem, scene.energy);
    ASSERT_EQ(chains.size(), 1u);
    EXPECT_THAT(chains[0], ElementsAreArray(dofsOf(problem, 0, {"left wrist", "left elbow"})));
}

TEST(DofsBeside, are_of_the_parts_there_and_of_what_they_hang_on) {
    const PoseProblem problem = aScene({1.7, 1.7});
    const std::vector<double> poses = aRow(problem, {-1.2, 1.2}, 2);
    Scene scene(problem, poses);
    const PosedBody& posed = scene.energy.posed(1);
    const Body::Point& fingers = problem.actors[1].parts[static_cast<std::size_t>(BodyPart::LeftHand)];
    const glm::dvec2 tip = problem.targets[0].frame.shadow(posed.point(fingers));
    const glm::dvec2 elbow = problem.targets[0].frame.shadow(posed.place(problem.actors[1].joint("left elbow")));
    const glm::dvec2 beyond = (tip - elbow) / glm::length(tip - elbow);
    const auto blotAt = [&](glm::dvec2 middle) {
        return drawn(360, 170, [&](int x, int y) { return glm::distance(glm::dvec2(x + 0.5, y + 0.5), middle) < 3; });
    };
    EXPECT_THAT(dofsBeside(scene.problem, scene.energy, std::vector{blotAt(tip)}),
                ElementsAreArray(dofsOf(problem, 1, {"left wrist", "left elbow"})));
    EXPECT_THAT(dofsBeside(scene.problem, scene.energy, std::vector{blotAt(tip + 12.0 * beyond)}), IsEmpty());
    EXPECT_THAT(dofsBeside(scene.problem, scene.energy, std::vector{BitMask(360, 170)}), IsEmpty());
}

}  // namespace
}  // namespace fantascope::theatre
