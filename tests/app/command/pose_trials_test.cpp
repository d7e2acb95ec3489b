#include "app/command/pose_trials.h"

#include "theatre/body/body.h"

#include <gmock/gmock.h>

#include <atomic>
#include <cmath>
#include <csignal>
#include <sstream>

namespace fantascope::app {
namespace {

using theatre::PoseProblem, theatre::PoseSearch;

// A hill, for one person: white below a half ellipse.
PoseProblem hill() {
    GreyImage picture(240, 140);
    for (int y = 20; y < 120; ++y)
        for (int x = 0; x < 240; ++x)
            if (std::hypot((x + 0.5 - 120) / 80, (y + 0.5 - 120) / 100) < 1) picture.at(x, y) = 1;
    const theatre::Stage stage;
    return {stage, theatre::PoseTarget::from(picture, stage, 1, 64).value(), {theatre::humanBody(1.7)}, {}};
}

// A hundredth of a second later each time that it is read; presses Ctrl-C when it is read so often.
class CountingClock final : public Clock {
public:
    explicit CountingClock(int ctrlC = -1) : ctrlC_(ctrlC) {}
    Time now() const override {
        const int count = ++count_;
        if (count == ctrlC_) std::raise(SIGINT);
        return std::chrono::milliseconds(10 * count);
    }
    void sleepUntil(Time) override {}

private:
    const int ctrlC_;
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

PoseTrials run(const PoseTrials::Options& options, int ctrlC = -1) {
    CountingClock clock(ctrlC);
    std::ostringstream progress;
    return PoseTrials::run(hill(), options, clock, progress, false);
}

void expectSame(const PoseTrials& a, const PoseTrials& b) {
    ASSERT_EQ(a.trials.size(), b.trials.size());
    for (std::size_t i = 0; i < a.trials.size(); ++i) {
        EXPECT_EQ(a.trials[i].freedoms, b.trials[i].freedoms) << i;
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
    EXPECT_NE(one.trials[0].freedoms, one.trials[1].freedoms);
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
    std::ostringstream progress;
    PoseTrials::run(hill(), options(1, 5, 1e6), clock, progress, false);
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
    EXPECT_EQ(cut.trials[0].freedoms.size(), theatre::humanBody(1.7).freedoms);
    EXPECT_EQ(cut.reason, PoseTrials::StopReason::Time);
}

// Ctrl-C in the first trial leaves it as it is, and in the fourth those that are finished.
TEST(PoseTrials, that_a_person_ends_keep_what_is_finished) {
    // How often the clock is read while so many trials run.
    const auto readsOf = [&](int trials) {
        CountingClock clock;
        std::ostringstream progress;
        PoseTrials::run(hill(), options(1, trials), clock, progress, false);
        return static_cast<int>(std::lround(100 * seconds(clock.now())));
    };
    const int half = readsOf(1) / 2;
    const PoseTrials early = run(options(1, {}), half);
    EXPECT_EQ(early.reason, PoseTrials::StopReason::Interrupted);
    EXPECT_EQ(early.finished, 0u);
    EXPECT_EQ(early.trials.size(), 1u);

    const PoseTrials late = run(options(1, {}), readsOf(3) + half);
    EXPECT_EQ(late.reason, PoseTrials::StopReason::Interrupted);
    EXPECT_EQ(late.finished, 3u);
    expectSame(late, run(options(1, 3)));
}

TEST(PoseTrials, tell_how_far_they_are) {
    CountingClock clock;
    std::ostringstream progress;
    auto many = options(1, 3);
    many.search.evaluations = 8000;
    PoseTrials::run(hill(), many, clock, progress, false);
    EXPECT_THAT(progress.str(), testing::HasSubstr("trial 1  none finished  energy "));
    EXPECT_THAT(progress.str(), testing::HasSubstr("  best IoU 0."));
    EXPECT_THAT(progress.str(), testing::HasSubstr(" % "));
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
}  // namespace fantascope::app
