#include "app/parts/part.h"

#include <gmock/gmock.h>

#include <atomic>
#include <condition_variable>
#include <mutex>

namespace fantascope::app {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::Pair;

// A rehearsal is the same every time only if the parts meet in one order. Example failure: all
// moments of one part before those of the next.
TEST(SteppedClock, lets_the_parts_work_at_their_exact_moments_in_order_of_time) {
    SteppedClock clock;
    std::vector<std::pair<char, Time>> log;
    const auto note = [&](char name) {
        return [&, name](Time moment) {
            EXPECT_EQ(clock.now(), moment);
            log.emplace_back(name, moment);
        };
    };
    clock.setParts({{.name = "a", .rate = 100, .work = note('a')}, {.name = "b", .rate = 50, .phase = 5ms, .work = note('b')}});
    clock.sleepUntil(20ms);
    EXPECT_THAT(log, ElementsAre(Pair('a', 0ms), Pair('b', 5ms), Pair('a', 10ms), Pair('a', 20ms)));
    EXPECT_EQ(clock.now(), 20ms);
}

TEST(SteppedClock, where_moments_meet_the_order_of_the_parts_decides) {
    SteppedClock clock;
    std::string order;
    clock.setParts({{.name = "b", .rate = 10, .work = [&](Time) { order += 'b'; }},
                    {.name = "a", .rate = 10, .work = [&](Time) { order += 'a'; }}});
    clock.sleepUntil(100ms);
    EXPECT_EQ(order, "baba");
}

TEST(SteppedClock, sleeping_in_several_steps_changes_nothing) {
    const auto moments = [](std::vector<Time> stops) {
        SteppedClock clock;
        std::vector<Time> log;
        clock.setParts({{.name = "a", .rate = 30, .work = [&](Time moment) { log.push_back(moment); }}});
        for (const Time stop : stops) clock.sleepUntil(stop);
        return log;
    };
    EXPECT_EQ(moments({1s}), moments({1ms, 333ms, 334ms, 1s}));
}

// The show is over, its lamps still fade. Example failure: the moments of those that go on begin
// anew.
TEST(SteppedClock, parts_of_another_rank_end_and_the_others_keep_their_moments) {
    SteppedClock clock;
    std::vector<Time> lighting, watch;
    clock.setParts(
        {{.name = "lighting", .rate = 100, .work = [&](Time moment) { lighting.push_back(moment); }, .rank = Rank::Lighting},
         {.name = "watch", .rate = 100, .work = [&](Time moment) { watch.push_back(moment); }, .rank = Rank::Watch}});
    clock.sleepUntil(10ms);
    clock.endAllBut(Rank::Lighting);
    clock.sleepUntil(30ms);
    EXPECT_THAT(lighting, ElementsAre(0ms, 10ms, 20ms, 30ms));
    EXPECT_THAT(watch, ElementsAre(0ms, 10ms));
}

TEST(PartThreads, parts_of_another_rank_end_and_the_others_go_on) {
    SteadyClock clock;
    std::atomic<int> lighting = 0, watch = 0;
    PartThreads threads(clock, {{.name = "lighting", .rate = 1000, .work = [&](Time) { ++lighting; }, .rank = Rank::Lighting},
                                {.name = "watch", .rate = 1000, .work = [&](Time) { ++watch; }, .rank = Rank::Watch}});
    while (watch == 0) std::this_thread::yield();
    threads.endAllBut(Rank::Lighting);
    const int watched = watch, lit = lighting;
    while (lighting < lit + 3) std::this_thread::yield();
    EXPECT_EQ(watch, watched);
}

// A thread that fell behind must not run after the moments it missed: a lamp wants the newest
// level, not all old ones.
TEST(PartThreads, a_part_that_is_late_goes_on_with_the_newest_moment) {
    ManualClock clock;
    std::mutex mutex;
    std::condition_variable changed;
    std::vector<Time> moments;
    clock.advanceTo(35ms);
    PartThreads threads(clock, {{.name = "a", .rate = 100, .work = [&](Time moment) {
                                     const std::lock_guard lock(mutex);
                                     moments.push_back(moment);
                                     changed.notify_one();
                                 }}});
    std::unique_lock lock(mutex);
    changed.wait(lock, [&] { return moments.size() >= 2; });  // the manual clock jumps on by itself when the part sleeps
    EXPECT_EQ(moments[0], 30ms);
    EXPECT_EQ(moments[1], 40ms);
}

}  // namespace
}  // namespace fantascope::app
