#include "theatre/search/pose_rounds.h"

#include "core/clock.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace fantascope::theatre {
namespace {

// A hill that one person cannot fill with so few evaluations.
PoseRounds::Task hill() {
    GreyImage picture(240, 140);
    for (int y = 20; y < 120; ++y)
        for (int x = 0; x < 240; ++x)
            if (std::hypot((x + 0.5 - 120) / 115, (y + 0.5 - 120) / 60) < 1) picture.at(x, y) = 1;
    PoseRounds::Task task;
    task.targets = {PoseTarget::from(picture, task.stage, 1, 64).value()};
    task.area = areaToFill(task.targets, task.stage);
    task.statures = {1.7};
    task.troupe = Troupe::of(task.area, 1, 1.0, task.statures).value();
    return task;
}

PoseRounds::Options options(int mostMore) { return {.evaluations = 1000, .seed = 5, .trials = 1, .mostMore = mostMore}; }

// Example failure: whoever comes in last is taken for the best.
TEST(PoseRounds, bring_in_one_more_while_the_poses_are_not_enough) {
    const ManualClock clock;
    std::vector<std::size_t> begun, notEnough;
    PoseRounds::Watch watch;
    watch.begins = [&] { begun.push_back(begun.size()); };
    watch.notEnough = [&](const PoseRounds::Round& round) { notEnough.push_back(round.problem.actors.size()); };
    const PoseRounds found = PoseRounds::run(hill(), options(2), clock, {}, watch).value();
    EXPECT_EQ(begun.size(), 3u);
    EXPECT_THAT(notEnough, testing::ElementsAre(1, 2)) << "nobody comes in after the last";
    ASSERT_EQ(found.rounds.size(), 3u);
    for (const PoseRounds::Round& round : found.rounds) {
        EXPECT_FALSE(round.best().isSatisfactory());
        EXPECT_FALSE(isBetter(round.best().quality, found.rounds.back().best().quality));
        EXPECT_EQ(round.evaluationsPerTrial, 1000);
    }
    EXPECT_EQ(PoseRounds::run(hill(), options(0), clock, {}, {}).value().rounds.size(), 1u);
}

TEST(PoseRounds, end_with_whoever_plays_when_somebody_ends_them) {
    const ManualClock clock;
    PoseRounds::Watch watch;
    watch.goesOn = [](const auto&) { return false; };
    const PoseRounds found = PoseRounds::run(hill(), options(2), clock, {}, watch).value();
    ASSERT_EQ(found.rounds.size(), 1u);
    EXPECT_EQ(found.rounds[0].trials.reason, PoseTrials::StopReason::Interrupted);
}

// The time that came before the search counts: of a budget that is spent the first trial is left,
// with the fewest evaluations.
TEST(PoseRounds, have_the_time_that_is_left_since_the_start) {
    ManualClock clock;
    clock.advance(std::chrono::seconds(30));
    PoseRounds::Options spent = options(0);
    spent.trials = {};
    spent.evaluations = {};
    spent.seconds = 30;
    const PoseRounds found = PoseRounds::run(hill(), spent, clock, {}, {}).value();
    EXPECT_EQ(found.rounds[0].evaluationsPerTrial, 1000);
    EXPECT_EQ(found.rounds[0].trials.reason, PoseTrials::StopReason::Time);
    EXPECT_EQ(found.rounds[0].trials.finished, 0u);
}

TEST(PoseRounds, refuse_a_prop_that_nobody_holds) {
    PoseRounds::Task task = hill();
    Prop prop;
    prop.name = "parcel";
    prop.holder = Prop::Holder{1, BodyPart::LeftHand};
    task.stage.props = {prop};
    const auto refused = PoseRounds::run(task, options(0), ManualClock(), {}, {});
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message(), testing::HasSubstr("prop 'parcel' is held by actor 2"));
}

}  // namespace
}  // namespace fantascope::theatre
