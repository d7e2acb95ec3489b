#include "theatre/search/pose_search.h"

#include "theatre/a_scene.h"
#include "theatre/energy/energy_terms.h"
#include "theatre/energy/scene_energy.h"
#include "theatre/masks.h"
#include "theatre/search/artefacts.h"
#include "theatre/search/dof_search.h"

#include "core/parallel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace fantascope::theatre {
namespace {

// A hill, for `actors` people: white below a half ellipse.
PoseProblem hill(int actors, double height = 1.5, int rows = 128) {
    GreyImage picture(240, 140);
    for (int y = 20; y < 120; ++y)
        for (int x = 0; x < 240; ++x)
            if (std::hypot((x + 0.5 - 120) / 80, (y + 0.5 - 120) / 100) < 1) picture.at(x, y) = 1;
    const Stage stage;
    PoseProblem problem{stage, {PoseTarget::from(picture, stage, height, rows).value()}, {}, {}};
    for (int i = 0; i < actors; ++i) problem.actors.push_back(humanBody(1.6 + 0.1 * i));
    return problem;
}

PoseSearch::Options evaluations(std::int64_t count) {
    PoseSearch::Options options;
    options.evaluations = count;
    return options;
}

TEST(PoseSearch, begins_with_people_who_stand_apart_and_look_at_the_screen) {
    for (int actors = 1; actors <= 8; ++actors) {
        const PoseProblem problem = hill(actors);
        const auto start = PoseSearch::start(problem);
        const auto quality = PoseSearch::measure(problem, start);
        EXPECT_TRUE(quality.isValid()) << actors;
        EXPECT_EQ(quality.terms.visible, 0) << actors;
        EXPECT_EQ(quality.terms.people, 0) << actors;
        for (const auto& actor : quality.actors) EXPECT_NEAR(actor.lowest, 0, 1e-3);
    }
}

// A target that is somebody's shadow and, apart from it, a box's that stands and a box's that he
// holds: the three shares are told apart.
TEST(PoseSearch, tells_what_props_bring) {
    PoseProblem problem = aScene({1.7});
    const std::vector<double> pose = aRow(problem, {-1}, 2);
    makeTarget(problem, pose);
    const double people = problem.targets[0].area;
    problem.stage.props = {aBox({0.6, 0.6, 0.2}, {1, 0.3, 2}), aBox({0.2, 0.2, 0.2}, {0.4, 0, 0})};
    problem.stage.props[1].holder = Prop::Holder{0, BodyPart::LeftHand};
    makeTarget(problem, pose);
    const double all = problem.targets[0].area;
    ASSERT_GT(all, 1.2 * people);
    auto quality = PoseSearch::measure(problem, pose);
    EXPECT_EQ(quality.iou, 1);
    EXPECT_NEAR(quality.iouWithoutProps, people / all, 1e-12);
    EXPECT_NEAR(quality.propsCover, 1 - people / all, 1e-12);
    problem.stage.props.clear();
    quality = PoseSearch::measure(problem, pose);
    EXPECT_NEAR(quality.iou, people / all, 1e-12);
    EXPECT_EQ(quality.iouWithoutProps, quality.iou);
    EXPECT_EQ(quality.propsCover, 0);
}

// The easy wrong version finds the shape with people who fall, or people who stand and no shape.
TEST(PoseSearch, finds_a_shape_that_people_can_hold) {
    const PoseProblem problem = hill(2);
    const auto before = PoseSearch::measure(problem, PoseSearch::start(problem));
    const auto trial = PoseSearch::run(problem, 1, evaluations(8000));
    EXPECT_LT(before.iou, 0.4);
    EXPECT_GT(trial.quality.iou, 0.85);
    EXPECT_TRUE(trial.quality.isValid());
    EXPECT_LT(trial.quality.energy, 0.3 * before.energy);
    EXPECT_EQ(trial.reason, PoseSearch::StopReason::Evaluations);
    EXPECT_GE(trial.evaluations, 8000);
}

// The easy wrong version finds a shape for the capsules and hands out people of flesh.
TEST(PoseSearch, what_it_ends_with_is_measured_and_found_on_the_skins) {
    PoseProblem problem = hill(2, 1.5, 256), dressed = problem;
    dressed.buildSkins();
    // The best of a few, as anybody takes it.
    PoseSearch::Trial trial;
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        const auto ofCapsules = PoseSearch::run(problem, seed, evaluations(12000));
        auto found = PoseSearch::run(dressed, seed, evaluations(12000));
        EXPECT_TRUE(found.quality.isValid());
        EXPECT_LT(found.quality.energy, PoseSearch::measure(dressed, ofCapsules.dofs).energy) << seed;
        if (found.quality.iou > trial.quality.iou) trial = std::move(found);
    }
    EXPECT_GT(trial.quality.iou, 0.95);
    std::vector<glm::vec3> skin;
    PosedBody posed;
    std::span<const double> dofs(trial.dofs);
    for (std::size_t i = 0; i < problem.actors.size(); ++i) {
        posed.pose(problem.actors[i], dofs.first(problem.actors[i].dofs));
        dofs = dofs.subspan(problem.actors[i].dofs);
        dressed.skins[i]->skin(problem.actors[i], posed, skin);
        float lowest = skin.front().y;
        for (const glm::vec3& vertex : skin) lowest = std::min(lowest, vertex.y);
        EXPECT_EQ(trial.quality.actors[i].lowest, double(lowest));
    }
}

TEST(PoseSearch, the_same_seed_gives_the_same_poses_on_any_number_of_threads) {
    const PoseProblem problem = hill(2);
    const auto trials = [&](std::uint64_t seed, int threads) {
        std::vector<PoseSearch::Trial> found(3);
        parallelFor(3, threads, [&](int i) {
            const auto number = static_cast<std::size_t>(i);
            found[number] = PoseSearch::run(problem, PoseSearch::trialSeed(seed, number), evaluations(1000));
        });
        return found;
    };
    const auto one = trials(5, 1), two = trials(5, 3);
    for (std::size_t i = 0; i < one.size(); ++i) EXPECT_EQ(one[i].dofs, two[i].dofs) << i;
    EXPECT_NE(one[0].dofs, one[1].dofs) << "trials have seeds of their own";
    EXPECT_EQ(one[1].dofs, PoseSearch::run(problem, one[1].seed, evaluations(1000)).dofs) << "a trial is repeated by its seed";
    EXPECT_NE(one[0].dofs, trials(6, 1)[0].dofs);
}

TEST(PoseSearch, stops_when_it_is_asked_to_with_what_it_has) {
    const PoseProblem problem = hill(1);
    const auto trial = PoseSearch::run(problem, 1, evaluations(1'000'000), [](const PoseSearch::Progress&) { return true; });
    EXPECT_EQ(trial.reason, PoseSearch::StopReason::Interrupted);
    EXPECT_LT(trial.evaluations, 1'000'000);
    EXPECT_EQ(trial.dofs.size(), problem.dofs());
}

TEST(PoseSearch, the_papers_method_refines_what_it_found_and_keeps_what_is_better) {
    const PoseProblem problem = hill(2, 1.5, 256);
    PoseSearch::Options options = evaluations(16'000);
    options.method = PoseSearch::Method::Paper;
    const auto before = PoseSearch::measure(problem, PoseSearch::start(problem));
    bool anyIsBetter = false;  // of half of the trials the refinement finds nothing better
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        const auto trial = PoseSearch::run(problem, seed, options);
        EXPECT_EQ(trial.reason, PoseSearch::StopReason::Evaluations);
        EXPECT_GE(trial.evaluations, 16'000);
        EXPECT_LT(trial.quality.energy, 0.5 * before.energy);
        ASSERT_GE(trial.history.size(), 2u);
        EXPECT_TRUE(std::is_sorted(trial.history.rbegin(), trial.history.rend()));
        anyIsBetter |= trial.history.back() < trial.history.front();
        EXPECT_NEAR(trial.history.back(), trial.quality.energy, 1e-9 * trial.quality.energy) << "what it ends with is the best";
    }
    EXPECT_TRUE(anyIsBetter);
}

// A board throws the target's shadow by itself: who hides behind it leaves nothing to be seen.
TEST(PoseSearch, the_papers_method_ends_when_nothing_is_to_be_seen) {
    PoseProblem problem = aScene({1.2});
    problem.stage.props.push_back(aBox({2.2, 2, 0.01}, {0, 1, 1.5}));
    setTarget(problem, drawn(360, 170, [](int x, int) { return x < 10; }));
    setTarget(problem, SceneEnergy(problem).beam(0).propShadow());
    PoseSearch::Options options = evaluations(6000);
    options.method = PoseSearch::Method::Paper;
    options.residual = 1e6;
    const auto clean = PoseSearch::run(problem, 1, options);
    EXPECT_EQ(clean.reason, PoseSearch::StopReason::Satisfied);
    EXPECT_LT(clean.evaluations, 6000);
    SceneEnergy energy(problem);
    energy.pose(clean.dofs);
    energy.terms();
    EXPECT_EQ(visibleArtefacts(problem.targets[0], energy.shadow()).count(), 0);
    options.residual = 0;
    EXPECT_EQ(PoseSearch::run(problem, 1, options).reason, PoseSearch::StopReason::Evaluations) << "an energy is never less";
}

TEST(PoseSearch, of_the_papers_method_repeats_and_knows_two_covariances) {
    const PoseProblem problem = hill(2);
    PoseSearch::Options options = evaluations(2000);
    options.method = PoseSearch::Method::Paper;
    const auto blocks = PoseSearch::run(problem, 3, options).dofs;
    EXPECT_EQ(PoseSearch::run(problem, 3, options).dofs, blocks);
    options.fullCovariance = true;
    const auto full = PoseSearch::run(problem, 3, options).dofs;
    EXPECT_EQ(PoseSearch::run(problem, 3, options).dofs, full);
    EXPECT_NE(full, blocks);
    EXPECT_NE(PoseSearch::run(problem, 3, evaluations(2000)).dofs, blocks) << "the other method";
}

TEST(PoseSearch, options_out_of_range_are_refused) {
    EXPECT_TRUE(evaluations(1000).check());
    EXPECT_FALSE(evaluations(999).check());
    PoseSearch::Options options;
    options.population = 2;
    ASSERT_FALSE(options.check());
    EXPECT_NE(options.check().error().message().find("population"), std::string::npos);
    options = {};
    options.residual = -1;
    ASSERT_FALSE(options.check());
    EXPECT_NE(options.check().error().message().find("residual"), std::string::npos);
}

// Every reason why poses are not valid, one at a time.
TEST(PoseSearch, poses_that_nobody_can_hold_are_not_valid) {
    const PoseProblem problem = hill(2);
    const auto start = PoseSearch::start(problem);
    const auto valid = [&](auto change) {
        auto dofs = start;
        change(dofs);
        return PoseSearch::measure(problem, dofs).isValid();
    };
    const std::size_t second = problem.actors[0].dofs;
    EXPECT_TRUE(valid([](auto&) {}));
    EXPECT_FALSE(valid([](auto& f) { f[1] += 0.05; })) << "floats";
    EXPECT_FALSE(valid([](auto& f) { f[1] -= 0.05; })) << "in the floor";
    EXPECT_FALSE(valid([&](auto& f) { std::copy(f.begin(), f.begin() + 3, f.begin() + static_cast<std::ptrdiff_t>(second)); }))
        << "in each other";
    EXPECT_FALSE(valid([&](auto& f) {
        const std::size_t knee = problem.actors[0].joints[problem.actors[0].joint("left knee")].first;
        f[knee] = -0.3;
    })) << "a knee bent forward";
    EXPECT_FALSE(valid([](auto& f) { f[2] = 0.02; })) << "in the screen";
}

TEST(DofSearch, changes_nothing_but_what_it_was_given) {
    const PoseProblem problem = hill(2);
    SceneEnergy energy(problem);
    DofSearch search(problem);
    const auto start = PoseSearch::start(problem);
    auto dofs = start;
    energy.pose(dofs);
    const double before = energy.energy();
    const std::size_t second = problem.actors[0].dofs;
    std::vector<std::size_t> which = {0, 2, second, second + 2};
    const Body::Joint& joint = problem.actors[1].joints[3];
    for (std::size_t k = 0; k < joint.motion.size(); ++k) which.push_back(second + joint.first + k);
    Rng rng(1);
    const double after = search.run(energy, dofs, which, {0.5, 12, 25}, rng);
    EXPECT_LT(after, before);
    EXPECT_EQ(search.evaluations(), 12 * 25);
    for (std::size_t i = 0; i < dofs.size(); ++i) {
        const bool given = std::find(which.begin(), which.end(), i) != which.end();
        EXPECT_EQ(dofs[i] != start[i], given) << i;
    }
    energy.pose(dofs);
    EXPECT_DOUBLE_EQ(energy.energy(), after) << "what it tells is what it left";
}

}  // namespace
}  // namespace fantascope::theatre
