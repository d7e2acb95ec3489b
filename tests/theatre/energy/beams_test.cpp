// Several lights, several screens and curved ones, with one set of poses.
#include "theatre/a_scene.h"
#include "theatre/body/actor_pose.h"
#include "theatre/search/artefacts.h"
#include "theatre/search/pose_search.h"
#include "theatre/search/silhouette_fit.h"

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

namespace fantascope::theatre {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr double kPixel = 2.5 / 128;

// The screen of the second beam stands at the right, and looks to the left.
Stage aCorner() {
    Stage stage = aStage({0, 0.1, 7});
    stage.screens.push_back({{3.2, 2}, -std::numbers::pi / 2});
    stage.beams.push_back({{-5, 0.1, 2}, 1});
    return stage;
}

PoseTarget emptyTarget(const Stage& stage, std::size_t beam) {
    PoseTarget target{ScreenFrame(stage, -180 * kPixel, 170 * kPixel, kPixel, 360, 170, beam), BitMask(360, 170), 0, {}, 2};
    target.beam = beam;
    return target;
}

// aScene() on a stage of any number of beams.
PoseProblem aSceneOn(const Stage& stage, const std::vector<double>& statures) {
    PoseProblem problem{stage, {}, {}, {}};
    for (std::size_t i = 0; i < stage.beams.size(); ++i) problem.targets.push_back(emptyTarget(stage, i));
    for (const double stature : statures) problem.actors.push_back(humanBody(stature));
    return problem;
}

// The shadows of poses become the targets.
void makeTargets(PoseProblem& problem, const std::vector<double>& poses) {
    SceneEnergy energy(problem);
    energy.pose(poses);
    energy.terms();
    for (std::size_t i = 0; i < problem.targets.size(); ++i) setTarget(problem.targets[i], energy.beam(i).shadow());
}

// Poses as they are in another frame.
std::vector<double> inFrameOf(const Screen& screen, const PoseProblem& problem, std::span<const double> poses) {
    std::vector<double> moved;
    const glm::dquat turn = glm::angleAxis(-screen.turn, glm::dvec3(0, 1, 0));
    for (const Body& body : problem.actors) {
        ActorPose pose = poseOf(body, poses.first(body.dofs));
        poses = poses.subspan(body.dofs);
        pose.root = screen.screenFromStage(pose.root);
        pose.turns[0] = turn * pose.turns[0];
        const std::vector<double> own = dofsOf(body, pose);
        moved.insert(moved.end(), own.begin(), own.end());
    }
    return moved;
}

EnergyTerms termsOf(const PoseProblem& problem, const std::vector<double>& poses) {
    SceneEnergy energy(problem);
    energy.pose(poses);
    return energy.terms();
}

// Two people whose arms are a little bent, and the targets that other poses make.
struct Corner {
    PoseProblem problem = aSceneOn(aCorner(), {1.7, 1.5});
    std::vector<double> wanted = aRow(problem, {-0.75, 0.75}, 2), poses;
    explicit Corner(double size = 0.15) {
        wanted[problem.actors[0].joints[problem.actors[0].joint("left elbow")].first] += 0.5;
        makeTargets(problem, wanted);
        Rng rng(7);
        poses = nudged(problem, wanted, rng, size);
    }
};

TEST(Beams, their_energy_is_that_of_each_and_of_physics_once) {
    const Corner corner;
    const EnergyTerms both = termsOf(corner.problem, corner.poses);
    // Each alone on a stage of its own, whose frame is its screen's.
    PoseProblem first = corner.problem, second = corner.problem;
    first.stage = aStage({0, 0.1, 7});
    first.targets = {first.targets[0]};
    const Screen& screen = corner.problem.stage.screens[1];
    second.stage = aStage(screen.screenFromStage(corner.problem.stage.beams[1].light));
    second.targets = {emptyTarget(second.stage, 0)};
    setTarget(second.targets[0], corner.problem.targets[1].mask);
    const EnergyTerms one = termsOf(first, corner.poses), other = termsOf(second, inFrameOf(screen, second, corner.poses));
    ASSERT_GT(one.coverage, 0.05);
    ASSERT_GT(other.coverage, 0.05);
    // A turned body's pixels may be rounded to their neighbours.
    constexpr double kRounding = 0.01;
    EXPECT_NEAR(both.coverage, one.coverage + other.coverage, kRounding * both.coverage);
    EXPECT_NEAR(both.contourPoint, one.contourPoint + other.contourPoint, kRounding * both.contourPoint);
    EXPECT_NEAR(both.contourNormal, one.contourNormal + other.contourNormal, kRounding * both.contourNormal);
    EXPECT_NEAR(both.contourCurvature, one.contourCurvature + other.contourCurvature, kRounding * both.contourCurvature);
    EXPECT_NEAR(both.coherence, one.coherence + other.coherence, 2);
    EXPECT_EQ(both.floor, one.floor);
    EXPECT_EQ(both.supportArea, one.supportArea);
    EXPECT_EQ(both.margin, one.margin);
    EXPECT_EQ(both.people, one.people);
    EXPECT_EQ(both.stageSet, one.stageSet);
}

// The same stage told from its second screen.
TEST(Beams, it_does_not_matter_which_screen_is_the_first) {
    const Corner corner;
    const Stage& stage = corner.problem.stage;
    const Screen& screen = stage.screens[1];
    Stage turned = aStage(stage.lightOnScreen(1));
    const glm::dvec3 origin = screen.screenFromStage({0, 0, 0});
    turned.screens.push_back({{origin.x, origin.z}, -screen.turn});
    turned.beams.push_back({screen.screenFromStage(stage.beams[0].light), 1});
    PoseProblem problem = aSceneOn(turned, {1.7, 1.5});
    setTarget(problem.targets[0], corner.problem.targets[1].mask);
    setTarget(problem.targets[1], corner.problem.targets[0].mask);
    const EnergyTerms one = termsOf(corner.problem, corner.poses),
                      other = termsOf(problem, inFrameOf(screen, problem, corner.poses));
    EXPECT_NEAR(one.total(problem.weights), other.total(problem.weights), 0.01 * one.total(problem.weights));
    EXPECT_NEAR(one.visible, other.visible, 1e-9);
    EXPECT_NEAR(one.stageSet, other.stageSet, 1e-6);
}

TEST(Beams, who_looks_at_any_screen_sees_it) {
    Corner corner;
    const auto facing = [&](double turn) {
        const Body& body = corner.problem.actors[0];
        std::vector<double> poses = body.restPose({0, body.joints[0].offset.y, 2}, rotationOf({0, turn, 0}));
        PoseProblem problem = corner.problem;
        problem.actors.resize(1);
        const double both = termsOf(problem, poses).visible;
        problem.stage = aStage({0, 0.1, 7});
        problem.targets = {problem.targets[0]};
        return std::pair(both, termsOf(problem, poses).visible);
    };
    EXPECT_EQ(facing(std::numbers::pi).first, 0);      // the first
    EXPECT_EQ(facing(std::numbers::pi / 2).first, 0);  // the second
    EXPECT_GT(facing(std::numbers::pi / 2).second, 0);
    EXPECT_GT(facing(-std::numbers::pi / 4).first, 1);  // neither
}

// In depth, where the first light sees next to nothing of it, everyone stands 6 cm off.
TEST(Beams, the_outline_is_fitted_on_every_screen) {
    const Corner corner;
    std::vector<double> poses = corner.wanted;
    const std::size_t second = corner.problem.actors[0].dofs;
    for (const std::size_t first : {std::size_t{0}, second}) poses[first + 2] += 0.06;
    SceneEnergy energy(corner.problem);
    SilhouetteFit(corner.problem).run(energy, poses, 40);
    for (const std::size_t first : {std::size_t{0}, second}) EXPECT_NEAR(poses[first + 2], 2, 0.012);
    PoseProblem knowing = corner.problem;
    knowing.stage = aStage({0, 0.1, 7});
    knowing.targets = {knowing.targets[0]};
    poses = corner.wanted;
    poses[2] += 0.06;
    SceneEnergy one(knowing);
    SilhouetteFit(knowing).run(one, poses, 40);
    EXPECT_GT(std::abs(poses[2] - 2), 0.02) << "one screen alone does not tell";
}

// What the fit takes for how a shadow moves: by the screen's turn, too.
TEST(Beams, a_shadow_moves_as_the_camera_at_its_light_says) {
    const Stage stage = aCorner();
    Rng rng(1);
    for (const std::size_t beam : {0u, 1u}) {
        const ScreenFrame frame(stage, -2, 3, 0.01, 400, 300, beam);
        for (int i = 0; i < 50; ++i) {
            const glm::dvec3 point(rng.uniform(-1, 1), rng.uniform(0, 2), rng.uniform(1, 3));
            const glm::dvec2 normal = glm::normalize(glm::dvec2(rng.uniform(-1, 1), rng.uniform(-1, 1)));
            const glm::dvec3 d = frame.fromLight(point);
            const glm::dvec3 slope =
                frame.onStage(frame.focus() / d.z * glm::dvec3(normal, -glm::dot(normal, glm::dvec2(d)) / d.z));
            for (int axis = 0; axis < 3; ++axis) {
                constexpr double kStep = 1e-6;
                glm::dvec3 step(0);
                step[axis] = kStep;
                const double measured = glm::dot(normal, frame.shadow(point + step) - frame.shadow(point - step)) / (2 * kStep);
                EXPECT_NEAR(slope[axis], measured, 1e-4) << beam << ", " << axis;
            }
        }
    }
}

TEST(Beams, every_screen_is_in_the_way) {
    const auto share = [](Stage stage, double x, double z) {
        PoseProblem problem = aSceneOn(stage, {1.7});
        problem.weights = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
        problem.weights.w11 = 1;
        std::vector<double> poses = aRow(problem, {x}, z);
        makeTargets(problem, poses);
        SceneEnergy energy(problem);
        energy.pose(poses);
        const double before = energy.energy();
        EXPECT_GT(before, 100);
        EXPECT_GT(PoseSearch::measure(problem, poses).actors[0].deepest, 0.01);
        return SilhouetteFit(problem).run(energy, poses, 40) / before;
    };
    EXPECT_LT(share(aCorner(), 3.2 - 0.8, 2), 0.02) << "fingers in the second";
    Stage curved = aStage({0, 0.1, 7});
    curved.screens[0].radius = 3;
    EXPECT_LT(share(curved, 0, 0.09), 0.02) << "hands in one that is hollow";
    curved.screens[0].radius = -3;
    EXPECT_LT(share(curved, 0, 0.05), 0.02) << "the body in one that bulges";
    // What somebody holds, too.
    PoseProblem problem = aSceneOn(aCorner(), {1.7});
    Prop staff = aBox({6, 0.03, 0.03}, {0, 0, 0});
    staff.holder = Prop::Holder{0, BodyPart::RightHand};
    problem.stage.props = {staff};
    const std::vector<double> poses = aRow(problem, {0}, 2);
    makeTargets(problem, poses);
    SceneEnergy energy(problem);
    energy.pose(poses);
    const std::size_t inCorner = energy.intrusions(0).size();
    problem.stage.screens[1].at.x = 9;
    SceneEnergy wide(problem);
    wide.pose(poses);
    EXPECT_EQ(inCorner, wide.intrusions(0).size() + 1);
}

// Behind a wall, to the first light.
TEST(Beams, who_is_hidden_from_one_light_alone_is_not_occluded) {
    PoseProblem problem = aSceneOn(aCorner(), {1.7});
    problem.stage.props = {aBox({4, 3, 0.1}, {0, 1.5, 4.5})};
    const std::vector<double> poses = aRow(problem, {0}, 1.5);
    makeTargets(problem, poses);
    const auto chains = [&](const PoseProblem& of) {
        SceneEnergy energy(of);
        energy.pose(poses);
        energy.terms();
        return occludedChains(of, energy);
    };
    EXPECT_EQ(chains(problem).size(), 1u) << "to the second light one leg is behind the other";
    problem.stage.beams.resize(1);
    problem.targets = {problem.targets[0]};
    EXPECT_EQ(chains(problem).size(), 5u) << "head, hands and feet";
}

// Where the second shadow sticks out at the height of a hand.
TEST(Beams, artefacts_of_any_screen_name_who_could_mend_them) {
    PoseProblem problem = aSceneOn(aCorner(), {1.7});
    std::vector<double> poses = aRow(problem, {0}, 2);
    makeTargets(problem, poses);
    poses[problem.actors[0].joints[problem.actors[0].joint("left shoulder")].first] += 1;
    poses[2] += 0.2;
    SceneEnergy energy(problem);
    energy.pose(poses);
    energy.terms();
    const std::vector<BitMask> artefacts = visibleArtefacts(energy);
    ASSERT_EQ(artefacts.size(), 2u);
    ASSERT_GT(artefacts[1].count(), 0);
    const std::vector<BitMask> ofSecond{BitMask(360, 170), artefacts[1]};
    EXPECT_THAT(dofsBeside(problem, energy, ofSecond), Not(IsEmpty()));
    EXPECT_THAT(dofsBeside(problem, energy, std::vector(2, BitMask(360, 170))), IsEmpty());
}

GreyImage picture(int width, int height, const std::function<bool(int, int)>& isWhite) {
    GreyImage image(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) image.at(x, y) = isWhite(x, y) ? 1 : 0;
    return image;
}
const GreyImage kWide = picture(300, 160, [](int x, int y) { return x >= 10 && x < 290 && y >= 10 && y < 150; });
const GreyImage kTall = picture(160, 300, [](int x, int y) { return x >= 40 && x < 120 && y >= 10 && y < 290; });

// A ball's shadow, by the rays from each place of the screen to the light: whether they pass the
// ball.
TEST(Beams, a_shadow_on_a_curved_screen_is_what_rays_say) {
    for (const double radius : {3.0, -3.0}) {
        Stage stage = aStage({0.2, 1.2, 6});
        stage.screens[0].radius = radius;
        const auto target = PoseTarget::from(kWide, stage, 1.6, 512);
        ASSERT_TRUE(target) << target.error().message();
        const PlacedSphere ball{{-0.4, 0.35, 2.5}, 0.3};
        BitMask shadow(target->mask.width(), target->mask.height());
        CapsuleShadow().add(target->frame, ball, shadow);
        target->cut(stage, shadow);
        const BitMask seen = target->asSeen(shadow);
        const ScreenFrame& frame = target->unrolled->frame;
        int white = 0, wrong = 0;
        for (int y = 0; y < seen.height(); ++y)
            for (int x = 0; x < seen.width(); ++x) {
                const glm::dvec2 place = frame.metresAt({x + 0.5, y + 0.5});
                const double angle = place.x / radius;
                const glm::dvec3 point(radius * std::sin(angle), place.y, radius - radius * std::cos(angle));
                const glm::dvec3 way = glm::normalize(stage.beams[0].light - point), to = ball.centre - point;
                const bool isHit = glm::length(to - glm::dot(to, way) * way) < ball.radius;
                white += isHit;
                wrong += isHit != seen.at(x, y);
            }
        EXPECT_GT(white, 12000);
        EXPECT_LT(wrong, 0.01 * white) << radius;  // half a pixel along the edge
    }
}

TEST(Beams, a_target_on_a_curved_screen_looks_as_it_was_drawn) {
    for (const double radius : {4.0, -4.0, 1.5})
        for (const double height : {0.0, 1.4}) {
            Stage stage = aStage({0.3, height, 6});
            const auto flat = PoseTarget::from(kWide, stage, 1.5, 256);
            stage.screens[0].radius = radius;
            const auto target = PoseTarget::from(kWide, stage, 1.5, 256);
            ASSERT_TRUE(target) << target.error().message();
            EXPECT_EQ(target->maskAsSeen(), flat->mask);
            EXPECT_GT(intersectionOverUnion(target->asSeen(target->mask), target->maskAsSeen()), 0.985)
                << radius << ", " << height;
            // What the light throws below the floor's line is on the floor, and no shadow of the
            // screen's.
            BitMask all(target->mask.width(), target->mask.height());
            for (int y = 0; y < all.height(); ++y) all.fill(y, 0, all.width());
            target->cut(stage, all);
            EXPECT_EQ(all, target->unrolled->onScreen);
            EXPECT_TRUE(isWithin(target->mask, all));
            const PoseTarget coarse = target->halved(stage);
            EXPECT_NEAR(coarse.area, 0.25 * target->area, 0.01 * target->area);
            EXPECT_GT(intersectionOverUnion(coarse.asSeen(coarse.mask), coarse.maskAsSeen()), 0.97);
        }
}

TEST(Beams, a_target_is_refused_where_the_light_does_not_come) {
    const auto refusal = [](const GreyImage& image, const Stage& stage, const TargetPlace& place) {
        const auto target = PoseTarget::from(image, stage, 2, 64, place);
        return target ? "laid" : target.error().message();
    };
    Stage stage = aCorner();
    EXPECT_EQ(refusal(kTall, stage, {}), "laid");
    EXPECT_EQ(refusal(kTall, stage, TargetPlace::on(stage, 1)), "laid");
    EXPECT_THAT(refusal(kTall, stage, {0, 3.0}), HasSubstr("screen 2 keeps the light from"));
    EXPECT_THAT(refusal(kTall, stage, {1, -1.9}), HasSubstr("screen 1 keeps the light from"));
    // 2 m to either side of a hollow screen are 2.09 m on the flat one.
    Stage hall = aStage({0, 0, 6}, Stage::Area{{-2.05, 0}, {2.05, 3}});
    EXPECT_EQ(refusal(kWide, hall, {}), "laid");
    hall.screens[0].radius = 4;
    EXPECT_THAT(refusal(kWide, hall, {}), HasSubstr("the projector lights x -2.05 .. 2.05 m"));
    stage.screens[0].radius = 1;
    EXPECT_THAT(refusal(kWide, stage, {}), HasSubstr("1.50 m to either side can be seen"));
    stage.screens[0].radius = -1.5;
    stage.beams[0].light.z = 3;
    EXPECT_THAT(refusal(kWide, stage, {}), HasSubstr("the light does not come to"));
    stage.screens[0].radius = -2;
    stage.beams[0].light.x = 5;
    EXPECT_THAT(refusal(kTall, stage, {}), HasSubstr("stands beside it"));
}

// Where people stand in front of the first light, there they throw a shadow from the others.
TEST(Beams, further_targets_are_where_the_same_people_throw_their_shadow) {
    const Stage stage = aCorner();
    const TargetPlace place = TargetPlace::on(stage, 1);
    ASSERT_TRUE(place.middle);
    // 1.8 m in front of the first screen is 0.2 m to the left of the second light's middle.
    EXPECT_NEAR(*place.middle, -0.2 * 8.2 / 5, 1e-9);
    EXPECT_NEAR(place.scale, 8.2 / 5 / (7 / 5.2), 1e-9);
    EXPECT_FALSE(TargetPlace::on(stage, 0).middle);
}

// 2 actors, before a corner; the second shadow is to be where they would not stand for the first.
TEST(Beams, a_search_serves_all_of_them_and_is_the_same_each_time) {
    const Stage stage = aCorner();
    PoseProblem problem{stage, {PoseTarget::from(kWide, stage, 0.9, 256).value()}, {humanBody(1.7), humanBody(1.7)}, {}};
    problem.targets.push_back(PoseTarget::from(kTall, stage, 1.6, 256, {1, *TargetPlace::on(stage, 1).middle + 1}).value());
    problem.buildSkins();
    PoseProblem one{aStage(stage.beams[0].light), {problem.targets[0]}, problem.actors, {}, problem.skins};
    for (const PoseSearch::Method method : {PoseSearch::Method::Refined, PoseSearch::Method::Paper}) {
        const PoseSearch::Options options{method, 4000};
        const PoseSearch::Trial both = PoseSearch::run(problem, 5, options), alone = PoseSearch::run(one, 5, options);
        const PoseSearch::Quality wide = PoseSearch::measure(problem, alone.dofs);
        ASSERT_EQ(wide.matches.size(), 2u);
        EXPECT_EQ(wide.iou, std::min(wide.matches[0].iou, wide.matches[1].iou));
        EXPECT_GT(both.quality.iou, wide.iou + 0.1);
        EXPECT_EQ(PoseSearch::run(problem, 5, options).dofs, both.dofs);
    }
}

// The first steps of a search must not begin in a screen.
TEST(Beams, people_start_before_every_screen) {
    Stage stage = aCorner();
    stage.screens[1].at.x = 0.5;
    PoseProblem problem = aSceneOn(stage, {1.7, 1.7, 1.7});
    const std::vector<double> start = PoseSearch::start(problem);
    makeTargets(problem, start);
    for (const PoseSearch::Actor& actor : PoseSearch::measure(problem, start).actors) EXPECT_LT(actor.deepest, 0.7);
    glm::dvec3 outward;
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t first = problem.firstDof(i);
        EXPECT_GT(stage.screens[1].distance({start[first], start[first + 1], start[first + 2]}, outward), 0.7);
    }
}

}  // namespace
}  // namespace fantascope::theatre
