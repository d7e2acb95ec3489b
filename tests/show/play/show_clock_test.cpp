#include "show/play/show_clock.h"

#include "core/random.h"

#include <gmock/gmock.h>

namespace fantascope::show {
namespace {

using namespace std::chrono_literals;

// Example failure: a show that is resumed at hour three counts three hours of late frames.
TEST(ShowClock, tells_the_time_of_the_show_from_that_of_this_run) {
    const ShowClock clock(100s, 3h);
    EXPECT_EQ(clock.runStart(), 100s);
    EXPECT_EQ(clock.runTime(160s), 60s);
    EXPECT_EQ(clock.showTime(160s), 3h + 60s);
    EXPECT_EQ(clock.showTime(40s), 3h - 60s) << "before its start as if it had begun earlier";
    EXPECT_EQ(clock.momentOf(3h + 5s, 0s), 105s);
    EXPECT_EQ(clock.momentOf(3h + 5s, 106s), std::nullopt) << "that is over";
    EXPECT_EQ(clock.rateAt(160s), 1);
}

TEST(ShowClock, stands_still_while_the_show_is_paused) {
    ShowClock clock(10s);
    clock.pause(15s);
    EXPECT_EQ(clock.showTime(12s), 2s) << "nothing changes before";
    EXPECT_EQ(clock.showTime(15s), 5s);
    EXPECT_EQ(clock.showTime(60s), 5s);
    EXPECT_EQ(clock.rateAt(60s), 0);
    EXPECT_EQ(clock.runTime(60s), 50s) << "the run goes on";
    EXPECT_EQ(clock.momentOf(6s, 20s), std::nullopt);
    clock.resume(100s);
    EXPECT_EQ(clock.showTime(101s), 6s);
    EXPECT_EQ(clock.momentOf(6s, 20s), 101s);
    EXPECT_EQ(clock.momentOf(5s, 20s), 20s) << "it stands there already";
}

TEST(ShowClock, jumps_to_where_it_is_told) {
    ShowClock clock(0s);
    clock.seek(10s, 2s);
    EXPECT_EQ(clock.showTime(10s - 1ns), 10s - 1ns);
    EXPECT_EQ(clock.showTime(10s), 2s);
    EXPECT_EQ(clock.momentOf(5s, 0s), 5s) << "the first time";
    EXPECT_EQ(clock.momentOf(5s, 6s), 13s) << "and once more";
    clock.pause(20s);
    clock.seek(30s, 100s);
    EXPECT_EQ(clock.showTime(40s), 100s) << "a jump does not end a pause";
}

TEST(ShowClock, goes_at_the_rate_it_is_told) {
    ShowClock clock(0s);
    clock.setRate(10s, 0.5);
    EXPECT_EQ(clock.showTime(12s), 11s);
    clock.pause(14s);
    clock.setRate(15s, 3);
    EXPECT_EQ(clock.showTime(16s), 12s) << "it is still paused";
    clock.resume(20s);
    EXPECT_EQ(clock.showTime(21s), 15s);
    EXPECT_EQ(clock.momentOf(18s, 0s), 22s);
}

// For any history: show time never goes back but by a seek, and momentOf() is where showTime() gets
// there first.
TEST(ShowClock, finds_the_moment_of_a_show_time) {
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        Rng rng(seed);
        const auto later = [&](Time most) {
            return Time(static_cast<Time::rep>(rng.uniform(0, 1) * static_cast<double>(most.count())));
        };
        ShowClock clock(later(10s), later(1h));
        Time moment = clock.runStart();
        for (int i = 0; i < 8; ++i) {
            moment += later(10s);
            if (rng.below(3) == 0) clock.pause(moment);
            if (rng.below(3) == 0) clock.resume(moment);
            if (rng.below(3) == 0) clock.setRate(moment, rng.uniform(0.1, 4));
            if (rng.below(6) == 0) clock.seek(moment, later(1h));
        }
        for (int i = 0; i < 50; ++i) {
            const Time since = clock.runStart() + later(60s), asked = clock.showTime(since + later(30s));
            const auto found = clock.momentOf(asked, since);
            ASSERT_TRUE(found) << "seed " << seed;
            ASSERT_GE(*found, since);
            ASSERT_LE(std::abs((clock.showTime(*found) - asked).count()), 4) << "seed " << seed;
        }
    }
}

}  // namespace
}  // namespace fantascope::show
