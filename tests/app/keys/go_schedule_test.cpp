#include "app/keys/go_schedule.h"

#include <gmock/gmock.h>

#include <vector>

namespace fantascope::app {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;

std::vector<Time> pressesOf(GoSchedule schedule) {
    std::vector<Time> presses;
    for (Time time{}; time < 70s; time += 10ms)
        while (schedule.due(time)) presses.push_back(time);
    return presses;
}

TEST(GoSchedule, reaches_every_cue_in_an_equal_share_of_the_length) {
    EXPECT_THAT(pressesOf({3, false, 60s}), ElementsAre(3340ms, 23340ms, 43340ms)) << "after a moment of darkness";
    EXPECT_THAT(pressesOf({2, true, 60s}), ElementsAre(20s, 40s)) << "the cue that is on has its share first";
    EXPECT_THAT(pressesOf({0, true, 60s}), ElementsAre());
}

TEST(GoSchedule, says_when_the_next_press_is) {
    GoSchedule schedule(2, true, 60s);
    EXPECT_EQ(schedule.next(), 20s);
    EXPECT_TRUE(schedule.due(20s));
    EXPECT_EQ(schedule.next(), 40s);
    EXPECT_TRUE(schedule.due(40s));
    EXPECT_EQ(schedule.next(), Time::max());
}

TEST(GoSchedule, ends_when_the_operator_takes_over) {
    GoSchedule schedule(3, false, 60s);
    EXPECT_TRUE(schedule.due(10s));
    schedule.end();
    EXPECT_FALSE(schedule.due(50s));
    EXPECT_TRUE(schedule.ended());
}

}  // namespace
}  // namespace fantascope::app
