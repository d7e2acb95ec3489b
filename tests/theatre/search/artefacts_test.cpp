#include "theatre/search/artefacts.h"

#include "a_scene.h"
#include "masks.h"

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
    return problem.target;
}

// The easy wrong version counts every pixel that differs, and there always are some along the
// outline.
TEST(VisibleArtefacts, AreWideAndNotOnlyLong) {
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

// All freedoms of these joints, the actors' one after the other.
Freedoms freedomsOf(const PoseProblem& problem, std::size_t actor, const std::vector<std::string_view>& joints) {
    std::size_t first = 0;
    for (std::size_t i = 0; i < actor; ++i) first += problem.actors[i].freedoms;
    const Body& body = problem.actors[actor];
    Freedoms freedoms;
    for (const std::string_view name : joints) {
        const Body::Joint& joint = body.joints[body.joint(name)];
        for (std::size_t k = 0; k < joint.motion.size(); ++k) freedoms.push_back(first + joint.first + k);
    }
    std::sort(freedoms.begin(), freedoms.end());
    return freedoms;
}
Freedoms allOf(const std::vector<Freedoms>& chains) {
    Freedoms all;
    for (const Freedoms& chain : chains) all.insert(all.end(), chain.begin(), chain.end());
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

TEST(OccludedChains, NobodyAloneWithHisArmsOutHasOne) {
    const PoseProblem problem = aScene({1.7});
    Scene scene(problem, aRow(problem, {0}, 2));
    EXPECT_THAT(occludedChains(scene.problem, scene.energy), IsEmpty());
}

TEST(OccludedChains, WhoIsBehindABoardIsFreeWholeButForHisPlace) {
    for (const std::size_t hidden : {std::size_t{0}, std::size_t{1}}) {
        PoseProblem problem = aScene({1.7, 1.7});
        const std::vector<double> poses = aRow(problem, {-1.2, 1.2}, 2);
        problem.stage.props.push_back(aBox({2, 2, 0.01}, {hidden == 0 ? -1.1 : 1.1, 0.9, 2.4}));
        Scene scene(problem, poses);
        Freedoms wanted(problem.actors[hidden].freedoms - Body::kRootFreedoms);
        std::iota(wanted.begin(), wanted.end(), hidden * problem.actors[0].freedoms + Body::kRootFreedoms);
        EXPECT_THAT(allOf(occludedChains(scene.problem, scene.energy)), ElementsAreArray(wanted)) << hidden;
    }
}

// The easy wrong version frees both of two that hide nobody but each other, and the shadow is gone.
TEST(OccludedChains, OfTwoThatHideEachOtherOneStays) {
    const PoseProblem problem = aScene({1.7, 1.7});
    Scene scene(problem, aRow(problem, {0, 0}, 2));
    const std::vector<Freedoms> chains = occludedChains(scene.problem, scene.energy);
    ASSERT_FALSE(chains.empty());
    for (const Freedoms& chain : chains)
        for (const std::size_t freedom : chain) EXPECT_LT(freedom, problem.actors[0].freedoms);
}

TEST(OccludedChains, BeginAtTheEndsAndPropsHideThemToo) {
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
    EXPECT_THAT(chains[0], ElementsAreArray(freedomsOf(problem, 0, {"left wrist", "left elbow"})));
}

TEST(FreedomsBeside, AreOfThePartsThereAndOfWhatTheyHangOn) {
    const PoseProblem problem = aScene({1.7, 1.7});
    const std::vector<double> poses = aRow(problem, {-1.2, 1.2}, 2);
    Scene scene(problem, poses);
    const PosedBody& posed = scene.energy.posed(1);
    const Body::Point& fingers = problem.actors[1].parts[static_cast<std::size_t>(BodyPart::LeftHand)];
    const glm::dvec2 tip = problem.target.frame.shadow(posed.point(fingers));
    const glm::dvec2 elbow = problem.target.frame.shadow(posed.place(problem.actors[1].joint("left elbow")));
    const glm::dvec2 beyond = (tip - elbow) / glm::length(tip - elbow);
    const auto blotAt = [&](glm::dvec2 middle) {
        return drawn(360, 170, [&](int x, int y) { return glm::distance(glm::dvec2(x + 0.5, y + 0.5), middle) < 3; });
    };
    EXPECT_THAT(freedomsBeside(scene.problem, scene.energy, std::vector{blotAt(tip)}),
                ElementsAreArray(freedomsOf(problem, 1, {"left wrist", "left elbow"})));
    EXPECT_THAT(freedomsBeside(scene.problem, scene.energy, std::vector{blotAt(tip + 12.0 * beyond)}), IsEmpty());
    EXPECT_THAT(freedomsBeside(scene.problem, scene.energy, std::vector{BitMask(360, 170)}), IsEmpty());
}

}  // namespace
}  // namespace fantascope::theatre
