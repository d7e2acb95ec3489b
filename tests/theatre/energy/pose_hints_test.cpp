#include "theatre/energy/pose_hints.h"

#include "theatre/a_scene.h"
#include "theatre/search/pose_search.h"
#include "theatre/search/silhouette_fit.h"

#include "core/file.h"
#include "scratch_folder.h"
#include "source_folder.h"

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>

namespace fantascope::theatre {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

const Stage kStage = aStage({0, 0.1, 7});

// A picture of 400 x 300 pixels with a white box of 100 x 200 in it, 2 m high on the screen: a
// pixel of it is 1 cm. The mask has 128 rows.
PoseTarget aTarget() {
    GreyImage picture(400, 300);
    for (int y = 60; y < 260; ++y)
        for (int x = 250; x < 350; ++x) picture.at(x, y) = 1;
    return PoseTarget::from(picture, kStage, 2, 128).value();
}

class HintsFile : public testing::Test {
protected:
    Result<std::vector<PoseHint>> read(const std::string& hints, const PoseTarget& target = aTarget(),
                                       const Stage& stage = kStage) {
        EXPECT_TRUE(writeFile(folder_ / "a.hints.yaml", "fantascope: hints\nversion: 1\nhints:\n" + hints));
        return readHints(folder_ / "a.hints.yaml", target, stage);
    }
    std::string refusal(const std::string& hints, const Stage& stage = kStage) {
        const auto found = read(hints, aTarget(), stage);
        return found ? "read" : found.error().message();
    }
    ScratchFolder folder_;
};

// The box' middle is 300 pixels across and 160 down; it stands on the floor with its middle before
// the light.
TEST_F(HintsFile, says_where_on_the_screen_a_point_of_the_picture_is) {
    const auto hints = read(
        "  - {name: middle, at: [0.75, 0.533333333333], parts: [head]}\n"
        "  - {name: left top, at: [0.625, 0.2], parts: [hands, left knee, left hand]}\n");
    ASSERT_TRUE(hints) << hints.error().message();
    ASSERT_EQ(hints->size(), 2u);
    EXPECT_LT(glm::distance((*hints)[0].place, {0, 1}), 1e-9);
    EXPECT_LT(glm::distance((*hints)[1].place, {-0.5, 2}), 1e-9);
    EXPECT_EQ((*hints)[1].name, "left top");
    EXPECT_THAT((*hints)[0].parts, ElementsAre(BodyPart::Head));
    EXPECT_THAT((*hints)[1].parts, ElementsAre(BodyPart::LeftHand, BodyPart::RightHand, BodyPart::LeftKnee));
}

TEST_F(HintsFile, is_right_for_the_same_picture_in_another_size_and_in_coarse_pixels) {
    GreyImage twice(800, 600);
    for (int y = 120; y < 520; ++y)
        for (int x = 500; x < 700; ++x) twice.at(x, y) = 1;
    const std::string line = "  - {name: a, at: [0.7, 0.4], parts: [feet]}\n";
    const auto one = read(line), large = read(line, PoseTarget::from(twice, kStage, 2, 128).value()),
               coarse = read(line, aTarget().halved(kStage));
    ASSERT_TRUE(one && large && coarse);
    EXPECT_LT(glm::distance((*one)[0].place, (*large)[0].place), 1e-9);
    EXPECT_LT(glm::distance((*one)[0].place, (*coarse)[0].place), 1e-9);
}

TEST_F(HintsFile, is_refused_with_the_place_the_hint_and_what_to_do) {
    EXPECT_THAT(refusal("  - {name: ear, at: [0.7, 1.2], parts: [head]}\n"),
                AllOf(HasSubstr("a.hints.yaml:4:21: hints[0].at"), HasSubstr("'ear' is at [0.7, 1.2], outside the picture"),
                      HasSubstr("divide")));
    // 15 pixels left of the white are 7.5 % of its height, 5 are 2.5 %.
    EXPECT_THAT(refusal("  - {name: ear, at: [0.5875, 0.5], parts: [head]}\n"),
                AllOf(HasSubstr("'ear' is 7 % of"), HasSubstr("up to 5 %"), HasSubstr("move it")));
    EXPECT_EQ(refusal("  - {name: ear, at: [0.6125, 0.5], parts: [head]}\n"), "read");
    EXPECT_THAT(refusal("  - {name: ear, at: [0, 0], parts: [head]}\n"), HasSubstr("'ear' is 1")) << "beyond the mask";
    EXPECT_THAT(refusal("  - {name: ear, at: [0.7, 0.5], parts: [head, elbow]}\n"),
                AllOf(HasSubstr("a.hints.yaml:4:47: hints[0].parts[1]"),
                      HasSubstr("hint 'ear': there is no body part 'elbow' (did you mean 'elbows'?)"),
                      HasSubstr("known are: head, neck"), HasSubstr("left elbow"), HasSubstr("feet")));
    EXPECT_THAT(refusal("  - {name: ear, at: [0.7, 0.5], parts: []}\n"),
                AllOf(HasSubstr("hint 'ear' has no body part"), HasSubstr("knees")));
    EXPECT_THAT(refusal("  - {name: ear, at: [0.7, 0.5]}\n"), HasSubstr("parts"));
    EXPECT_THAT(refusal("  - {name: ear, at: [0.7, 0.5], parts: [head]}\n  - {name: ear, at: [0.7, 0.6], parts: [head]}\n"),
                AllOf(HasSubstr("a.hints.yaml:5:12:"), HasSubstr("two hints are called 'ear'")));
    EXPECT_THAT(refusal("  - {name: ear, at: [0.7, 0.5], parts: [head], weight: 2}\n"), HasSubstr("unknown key"));
}

// A stage with a box that stands and a stick in somebody's hand.
Stage stageWithProps() {
    Stage stage = kStage;
    stage.props = {aBox({0.1, 0.1, 0.1}, {0, 0.1, 2}), aBox({0.1, 1, 0.1}, {0.2, 0, 0})};
    stage.props[1].name = "stick";
    stage.props[1].holder = Prop::Holder{1, BodyPart::LeftHand};
    stage.props[1].turn = rotationOf({0, 0, std::numbers::pi / 2});
    return stage;
}

TEST_F(HintsFile, may_mean_a_point_of_what_somebody_holds) {
    const auto hints = read("  - {name: tip, at: [0.75, 0.5], prop: stick, point: [0, 0.5, 0]}\n", aTarget(), stageWithProps());
    ASSERT_TRUE(hints) << hints.error().message();
    ASSERT_TRUE((*hints)[0].held);
    EXPECT_TRUE((*hints)[0].parts.empty());
    EXPECT_EQ((*hints)[0].held->holder.actor, 1u);
    EXPECT_LT(glm::distance((*hints)[0].held->local, {0.2 - 0.5, 0, 0}), 1e-9) << "turned with the prop";

    const auto with = [&](const std::string& rest) {
        return refusal("  - {name: tip, at: [0.75, 0.5]" + rest + "}\n", stageWithProps());
    };
    EXPECT_THAT(with(""), HasSubstr("hint 'tip' has neither parts nor a prop"));
    EXPECT_THAT(with(", parts: [head], prop: stick"), HasSubstr("hint 'tip' has both parts and a prop"));
    EXPECT_THAT(with(", prop: box"), AllOf(HasSubstr("the prop 'box' stands"), HasSubstr("put it there in the stage file")));
    EXPECT_THAT(with(", prop: stock"), AllOf(HasSubstr("nobody on the stage holds 'stock'"), HasSubstr("held are: stick")));
    EXPECT_THAT(refusal("  - {name: tip, at: [0.75, 0.5], prop: stick}\n"), HasSubstr("no prop with held_by"));
}

TEST_F(HintsFile, of_each_of_the_projects_silhouettes_is_read) {
    int files = 0;
    for (const auto& file : std::filesystem::recursive_directory_iterator(sourceFolder() + "/assets/silhouettes")) {
        const std::string path = file.path().string(), ending = ".hints.yaml";
        if (!path.ends_with(ending)) continue;
        const auto picture = readGrey(path.substr(0, path.size() - ending.size()) + ".png");
        ASSERT_TRUE(picture);
        const auto hints = readHints(path, PoseTarget::from(*picture, kStage, 2, 256).value(), kStage);
        ASSERT_TRUE(hints) << hints.error().message();
        EXPECT_FALSE(hints->empty()) << path;
        ++files;
    }
    EXPECT_EQ(files, 6);
}

TEST(BodyParts, words_are_one_side_or_both) {
    EXPECT_THAT(partsOf("hands"), ElementsAre(BodyPart::LeftHand, BodyPart::RightHand));
    EXPECT_THAT(partsOf("feet"), ElementsAre(BodyPart::LeftFoot, BodyPart::RightFoot));
    EXPECT_THAT(partsOf("right knee"), ElementsAre(BodyPart::RightKnee));
    EXPECT_THAT(partsOf("head"), ElementsAre(BodyPart::Head));
    EXPECT_TRUE(partsOf("hand").empty());
    for (const std::string& word : partWords()) EXPECT_FALSE(partsOf(word).empty()) << word;
    for (std::size_t i = 0; i < kBodyParts; ++i) EXPECT_EQ(partNames()[i], name(static_cast<BodyPart>(i)));
}

// In the T-pose, in shares of the stature: fingers at .538, crown at .999, toes .1116 before.
TEST(BodyParts, are_points_of_the_skin) {
    const Body body = humanBody(2);
    PosedBody posed;
    posed.pose(body, body.restPose(body.joints[0].offset, {1, 0, 0, 0}));
    const auto at = [&](BodyPart part) { return posed.point(body.parts[static_cast<std::size_t>(part)]); };
    EXPECT_LT(glm::distance(at(BodyPart::LeftHand), {1.076, 1.6224, -0.006}), 1e-6);
    EXPECT_LT(glm::distance(at(BodyPart::RightHand), {-1.076, 1.6224, -0.006}), 1e-6);
    EXPECT_LT(glm::distance(at(BodyPart::Head), {0, 1.998, 0.0092}), 1e-6);
    EXPECT_LT(glm::distance(at(BodyPart::RightFoot), {-0.0862, 0.0236, 0.2232}), 1e-6);
    for (std::size_t part = 0; part < kBodyParts; ++part) {
        // Corners are a little inside while the limb is straight.
        double out = 1;
        for (const PlacedCapsule& capsule : posed.capsules()) {
            const glm::dvec3 point = posed.point(body.parts[part]);
            out = std::min(out, -penetration(capsule, {{point, 0}, {point, 0}}));
        }
        EXPECT_NEAR(out, 0, 0.02) << partNames()[part];
    }
}

glm::dvec3 partOf(const PoseProblem& problem, BodyPart part) {
    return problem.actors[1].parts[static_cast<std::size_t>(part)].local;
}

// By hand: the light at 7 m and a hand at 2.006 m make everything 7 / 4.994 times as large. The
// left hand of one who looks at the screen is on the left of the picture.
TEST(MatchHints, measures_the_nearest_shadow_in_pixels_of_256) {
    PoseProblem problem = aScene({2.0, 2.0});
    const std::vector<double> poses = aRow(problem, {-1, 1}, 2);
    makeTarget(problem, poses);
    const ScreenFrame& frame = problem.targets[0].frame;
    const double larger = 7 / 4.994, handX = larger * (1 + 1.076), handY = 0.1 + larger * (1.6224 - 0.1);
    // Three mask pixels right of and four above the second one's right hand.
    problem.hints = {{"a", {handX + 3 * frame.pixel(), handY + 4 * frame.pixel()}, {BodyPart::LeftHand, BodyPart::RightHand}}};
    SceneEnergy energy(problem);
    energy.pose(poses);
    EXPECT_NEAR(energy.terms().hint, 4 * 25, 1e-6) << "a pixel of this mask is two of 256";
    EXPECT_EQ(energy.hintOwner(0).actor, 1u);
    EXPECT_EQ(energy.hintOwner(0).match.point->local, partOf(problem, BodyPart::RightHand));
    EXPECT_LT(glm::distance(energy.hintOwner(0).match.away, {-3, 4}), 1e-6);
    const double all = energy.energy();
    problem.weights.w12 = 0;
    EXPECT_NEAR(all - energy.energy(), 0.25 * 100, 1e-6);
    // Only elbows may: the same actor's, 24.9 cm of arm and finger nearer.
    problem.hints[0].parts = {BodyPart::RightElbow, BodyPart::Pelvis};
    energy.pose(poses);
    EXPECT_GT(energy.terms().hint, 4 * 400);
    EXPECT_EQ(energy.hintOwner(0).match.point->local, partOf(problem, BodyPart::RightElbow));
    // A second hint adds its own.
    const double one = energy.terms().hint;
    problem.hints.push_back({"b", {-handX, handY}, {BodyPart::LeftHand}});
    SceneEnergy both(problem);
    both.pose(poses);
    EXPECT_NEAR(both.terms().hint, one, 1e-6);
    EXPECT_EQ(both.hintOwner(1).actor, 0u);
}

TEST(MatchHints, one_beyond_the_light_matches_nothing) {
    PoseProblem problem = aScene({1.7});
    std::vector<double> pose = aRow(problem, {0}, 2);
    makeTarget(problem, pose);
    problem.hints = {{"a", {0, 1}, {BodyPart::Head}}};
    SceneEnergy energy(problem);
    pose[2] = 8;
    energy.pose(pose);
    EXPECT_TRUE(std::isfinite(energy.terms().hint));
    EXPECT_GT(energy.terms().hint, 1e5);
}

// Where the elbow's shadow is and where it is to be, in pixels of 256.
double elbowAway(const PoseProblem& problem, const std::vector<double>& poses) {
    SceneEnergy energy(problem);
    energy.pose(poses);
    return std::sqrt(energy.terms().hint);
}

// The second one's stick, whoever of the others is nearer; the fit swings it there.
TEST(Hints, lead_the_fit_to_bring_what_is_held_to_the_point) {
    PoseProblem problem = aScene({1.7, 1.7});
    problem.stage = stageWithProps();
    std::vector<double> poses = aRow(problem, {-1, 1}, 2);
    makeTarget(problem, poses);
    problem.hints = {{"tip", {0.3, 2.6}, {}, PoseHint::Held{*problem.stage.props[1].holder, {-0.3, 0, 0}}}};
    problem.weights = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1};
    SceneEnergy energy(problem);
    energy.pose(poses);
    const double before = energy.terms().hint;
    EXPECT_GT(before, 35 * 35);
    const auto owner = energy.hintOwner(0);
    EXPECT_EQ(owner.actor, 1u);
    // Its shadow is where the prop's own point says.
    const glm::dvec3 tip = energy.held(1)[0].point({0, 0.5, 0});
    const glm::dvec2 wanted = problem.targets[0].frame.pixelAt(0.3, 2.6);
    EXPECT_LT(glm::distance(problem.targets[0].frame.shadow(tip) - wanted, owner.match.away), 1e-6);
    const std::vector<double> others(poses.begin(), poses.begin() + static_cast<std::ptrdiff_t>(problem.actors[0].dofs));
    SilhouetteFit(problem).run(energy, poses, 30);
    EXPECT_LT(energy.terms().hint, 4);
    EXPECT_TRUE(std::equal(others.begin(), others.end(), poses.begin())) << "it is nobody else's";
}

TEST(Hints, lead_the_fit_to_bring_an_elbow_to_the_point) {
    PoseProblem problem = aScene({1.7});
    std::vector<double> poses = aRow(problem, {0}, 2);
    makeTarget(problem, poses);
    // Some 40 cm above where the right elbow is.
    problem.hints = {{"a", {0.6, 2.3}, {BodyPart::LeftElbow, BodyPart::RightElbow}}};
    problem.weights = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1};
    EXPECT_GT(elbowAway(problem, poses), 35);
    SceneEnergy energy(problem);
    SilhouetteFit(problem).run(energy, poses, 30);
    EXPECT_LT(elbowAway(problem, poses), 1);
}

TEST(Hints, lead_the_search_to_bring_an_elbow_to_the_point) {
    GreyImage picture(240, 140);
    for (int y = 20; y < 120; ++y)
        for (int x = 0; x < 240; ++x)
            if (std::hypot((x + 0.5 - 120) / 80, (y + 0.5 - 120) / 100) < 1) picture.at(x, y) = 1;
    PoseProblem problem{kStage, {PoseTarget::from(picture, kStage, 1.5, 128).value()}, {humanBody(1.6)}, {}, {}};
    PoseSearch::Options options;
    options.evaluations = 3000;
    const auto away = [&](double weight) {
        // The hill's top, where without a wish a head goes.
        problem.hints = {{"top", {0, 1.48}, {BodyPart::LeftElbow, BodyPart::RightElbow}}};
        problem.weights.w12 = weight;
        return elbowAway(problem, PoseSearch::run(problem, 1, options).dofs);
    };
    const double without = away(0), with = away(0.25);
    EXPECT_LT(with, 10);
    EXPECT_GT(without, 2 * with);
}

}  // namespace
}  // namespace fantascope::theatre
