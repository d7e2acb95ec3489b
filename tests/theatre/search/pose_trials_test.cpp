#include "theatre/search/pose_trials.h"

#include "theatre/body/body.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <vector>

namespace fantascope::theatre {
namespace {

// A hill, for one person: white below a half ellipse.
PoseProblem hill() {
    GreyImage picture(240, 140);
    for (int y = 20; y < 120; ++y)
        for (int x = 0; x < 240; ++x)
            if (std::hypot((x + 0.5 - 120) / 80, (y + 0.5 - 120) / 100) < 1) picture.at(x, y) = 1;
    const Stage stage;
    return {stage, {PoseTarget::from(picture, stage, 1, 64).value()}, {humanBody(1.7)}, {}};
}

// A hundredth of a second later each time that it is read.
class CountingClock final : public Clock {
public:
    Time now() const override { return std::chrono::milliseconds(10 * ++count_); }
    void sleepUntil(Time) override {}

private:
    mutable std::atomic<int> count_ = 0;
};

PoseTrials::Options options(int threads, std::optional<int> trials, std::optional<double> seconds = {}) {
    PoseTrials::Options options;
    options.search.evaluations = 1000;
    options.seed = 5;
    options.threads = threads;
    options.trials = trials;
    options.seconds = seconds;
    return options;
}

// `end`: somebody ends it when asked so often.
PoseTrials run(const PoseTrials::Options& options, int end = -1) {
    CountingClock clock;
    int asked = 0;
    return PoseTrials::run(hill(), options, clock, {.goesOn = [&](const auto&) { return ++asked != end; }});
}

void expectSame(const PoseTrials& a, const PoseTrials& b) {
    ASSERT_EQ(a.trials.size(), b.trials.size());
    for (std::size_t i = 0; i < a.trials.size(); ++i) {
        EXPECT_EQ(a.trials[i].dofs, b.trials[i].dofs) << i;
        EXPECT_EQ(a.trials[i].number, b.trials[i].number);
        EXPECT_EQ(a.trials[i].seed, b.trials[i].seed);
    }
    EXPECT_EQ(a.bestFirst(), b.bestFirst());
}

TEST(PoseTrials, are_the_same_on_any_number_of_threads) {
    const PoseTrials one = run(options(1, 4)), three = run(options(3, 4));
    EXPECT_EQ(one.trials.size(), 4u);
    EXPECT_EQ(one.finished, 4u);
    EXPECT_EQ(one.reason, PoseTrials::StopReason::Trials);
    expectSame(one, three);
    EXPECT_NE(one.trials[0].dofs, one.trials[1].dofs);
}

// The easy wrong version waits to the end for what does not satisfy.
TEST(PoseTrials, end_early_only_where_nothing_satisfies) {
    PoseTrials::Options impatient = options(1, std::nullopt, 1e6);
    impatient.patience = 0.01;
    const PoseTrials ended = run(impatient);
    EXPECT_EQ(ended.reason, PoseTrials::StopReason::Time);
    EXPECT_LT(ended.seconds, 1e3);
    for (const auto& trial : ended.trials) EXPECT_FALSE(trial.isSatisfactory());
}

// Example failure: a trial that the time cut short, or one that came after it, is the best, and
// --trials does not find it again.
TEST(PoseTrials, that_ended_by_time_are_repeated_by_their_number) {
    // As long as five trials take, and a little: of those on three threads two at least are
    // finished.
    CountingClock clock;
    PoseTrials::run(hill(), options(1, 5, 1e6), clock);
    const double limit = 1.05 * seconds(clock.now());
    for (const int threads : {1, 3}) {
        const PoseTrials timed = run(options(threads, {}, limit));
        EXPECT_EQ(timed.reason, PoseTrials::StopReason::Time);
        ASSERT_GE(timed.finished, 2u);
        EXPECT_LE(timed.finished, 8u);
        ASSERT_EQ(timed.trials.size(), timed.finished);
        for (const auto& trial : timed.trials) EXPECT_TRUE(trial.isFinished());
        expectSame(timed, run(options(1, static_cast<int>(timed.finished))));
    }
}

TEST(PoseTrials, that_have_no_time_leave_what_there_is) {
    const PoseTrials cut = run(options(2, {}, 0.0));
    ASSERT_GE(cut.trials.size(), 1u);
    EXPECT_EQ(cut.finished, 0u);
    EXPECT_FALSE(cut.trials[0].isFinished());
    EXPECT_EQ(cut.trials[0].dofs.size(), humanBody(1.7).dofs);
    EXPECT_EQ(cut.reason, PoseTrials::StopReason::Time);
}

// Ended in the first trial it stays as it is, and in the fourth those stay that are finished.
TEST(PoseTrials, that_somebody_ends_keep_what_is_finished) {
    const auto asksOf = [&](int trials) {
        int asks = 0;
        PoseTrials::run(hill(), options(1, trials), CountingClock(), {.goesOn = [&](const auto&) { return ++asks > 0; }});
        return asks;
    };
    const int half = asksOf(1) / 2;
    const PoseTrials early = run(options(1, {}), half);
    EXPECT_EQ(early.reason, PoseTrials::StopReason::Interrupted);
    EXPECT_EQ(early.finished, 0u);
    EXPECT_EQ(early.trials.size(), 1u);

    const PoseTrials late = run(options(1, {}), asksOf(3) + half);
    EXPECT_EQ(late.reason, PoseTrials::StopReason::Interrupted);
    EXPECT_EQ(late.finished, 3u);
    expectSame(late, run(options(1, 3)));
}

// Example failure: a pause is told as if the search went on, and the bar runs backwards.
TEST(PoseTrials, tell_how_far_they_are) {
    std::vector<TrialsProgress> told;
    int asked = 0;
    PoseTrials::run(hill(), options(1, 3), CountingClock(),
                    {.tell = [&](const TrialsProgress& now) { told.push_back(now); },
                     .goesOn =
                         [&](const std::function<void()>& whilePaused) {
                             if (++asked == 3) whilePaused();
                             return true;
                         }});
    ASSERT_GT(told.size(), 3u);
    EXPECT_EQ(told.front().trial, 0u);
    EXPECT_FALSE(told.front().best);
    EXPECT_EQ(told.back().trial, 2u);
    EXPECT_TRUE(told.back().best);
    EXPECT_EQ(std::count_if(told.begin(), told.end(), [](const auto& now) { return now.isPaused; }), 1);
    for (std::size_t i = 1; i < told.size(); ++i) EXPECT_GE(told[i].share, told[i - 1].share) << i;
    EXPECT_GT(told.back().energy, 0);
}

// What somebody may choose from is the best, and whatever is as good to an audience; never what
// falls.
TEST(PoseTrials, are_accepted_if_they_are_held_and_nearly_as_good) {
    PoseTrials found;
    const auto add = [&](double iou, bool stands) {
        PoseTrials::Trial trial;
        trial.number = found.trials.size();
        trial.quality.iou = iou;
        trial.quality.actors = {{.margin = 0.02, .touches = stands, .withinLimits = true}};
        found.trials.push_back(trial);
    };
    const auto accepted = [&] {
        std::vector<std::size_t> numbers;
        for (const PoseTrials::Trial* trial : found.accepted()) numbers.push_back(trial->number);
        return numbers;
    };
    add(0.8, true), add(0.785, true), add(0.77, true), add(0.81, false);
    EXPECT_THAT(accepted(), testing::ElementsAre(0, 1));
    add(0.99, true), add(0.955, true);
    EXPECT_THAT(accepted(), testing::ElementsAre(4, 5));
    found.trials.resize(0);
    add(0.3, false), add(0.31, false);
    EXPECT_THAT(accepted(), testing::ElementsAre(1)) << "the best, though nobody can hold it";
}

TEST(PoseTrials, the_best_can_be_held_and_then_has_the_best_shadow) {
    PoseTrials found;
    const auto add = [&](double iou, bool stands) {
        PoseTrials::Trial trial;
        trial.quality.iou = iou;
        trial.quality.actors = {{.margin = 0.02, .touches = stands, .withinLimits = true}};
        found.trials.push_back(trial);
    };
    add(0.9, true), add(0.99, false), add(0.96, true), add(0.96, true), add(0.5, false);
    EXPECT_THAT(found.bestFirst(), testing::ElementsAre(2, 3, 0, 1, 4));
    EXPECT_TRUE(found.trials[2].isSatisfactory());
    EXPECT_FALSE(found.trials[0].isSatisfactory());
    EXPECT_FALSE(found.trials[1].isSatisfactory());
}

}  // namespace
}  // namespace fantascope::theatre
