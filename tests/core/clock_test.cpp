#include "core/clock.h"

#include <gmock/gmock.h>

#include <thread>

namespace fantascope {
namespace {

using namespace std::chrono_literals;

TEST(Time, seconds_and_nanoseconds_turn_into_each_other) {
    EXPECT_EQ(fromSeconds(1.5), 1500ms);
    EXPECT_EQ(fromSeconds(-1e-9), -1ns);
    EXPECT_EQ(fromSeconds(0.9999999996), 1s) << "rounded, not cut";
    EXPECT_EQ(seconds(Time(250ms)), 0.25);
}

// A night has ten hours and an installation many nights. Example failure: a period rounded to a
// nanosecond adds up to 20 ms by the morning.
TEST(Time, ticks_stay_exact_over_days) {
    constexpr std::int64_t kDays = 100 * 24 * 3600;
    EXPECT_EQ(tickTime(1, 60), 16'666'667ns);
    EXPECT_EQ(tickTime(60 * kDays, 60), Time(std::chrono::seconds(kDays)));
    EXPECT_EQ(tickTime(44 * kDays + 1, 44), Time(std::chrono::seconds(kDays)) + 22'727'273ns);
    EXPECT_EQ(tickTime(-3, 2), -1500ms);
}

TEST(Time, the_tick_at_a_time_is_the_last_one_that_was) {
    for (const double hertz : {1.0, 29.97, 30.0, 44.0, 59.94, 60.0, 144.0, 1000.0 / 3.0}) {
        for (const std::int64_t tick : {std::int64_t{0}, std::int64_t{1}, std::int64_t{2}, std::int64_t{3},
                                        std::int64_t{1'000'003}, std::int64_t{987'654'321}}) {
            const Time at = tickTime(tick, hertz);
            EXPECT_EQ(tickAt(at, hertz), tick) << hertz << " Hz";
            EXPECT_EQ(tickAt(at - 1ns, hertz), tick - 1) << hertz << " Hz, tick " << tick;
            EXPECT_EQ(tickAt(tickTime(tick + 1, hertz) - 1ns, hertz), tick) << hertz << " Hz, tick " << tick;
        }
    }
}

TEST(ManualClock, moves_only_when_told_and_never_back) {
    ManualClock clock;
    EXPECT_EQ(clock.now(), 0ns);
    clock.advance(2s);
    clock.advanceTo(1s);
    EXPECT_EQ(clock.now(), 2s);
    clock.sleepUntil(5s);
    EXPECT_EQ(clock.now(), 5s) << "who sleeps moves it";
}

TEST(ManualClock, the_furthest_of_several_threads_wins) {
    ManualClock clock;
    {
        std::vector<std::jthread> threads;
        for (int thread = 0; thread < 4; ++thread)
            threads.emplace_back([&clock, thread] {
                for (int step = 0; step < 1000; ++step) {
                    const Time target(step * 4 + thread);
                    clock.advanceTo(target);
                    EXPECT_GE(clock.now(), target);
                }
            });
    }
    EXPECT_EQ(clock.now(), 3999ns);
}

TEST(SteadyClock, starts_at_zero_and_sleeps_until_its_time) {
    SteadyClock clock;
    const Time before = clock.now();
    EXPECT_GE(before, 0ns);
    clock.sleepUntil(before + 1ms);
    EXPECT_GE(clock.now(), before + 1ms);
    clock.sleepUntil(0ns);  // is past, so it returns
}

}  // namespace
}  // namespace fantascope
