#include "app/live/held_frame.h"

#include <gtest/gtest.h>

namespace fantascope::app {
namespace {

using namespace std::chrono_literals;

constexpr Time kPeriod = 20ms, kDue = 1s;

HeldFrame drawnIn(Time took) {
    HeldFrame held;
    for (int i = 0; i < 200; ++i) held.drawn(took);
    return held;
}

TEST(HeldFrame, waits_until_there_is_just_time_to_draw_it_again) {
    EXPECT_EQ(drawnIn(1ms).until(kDue, kPeriod), kDue - 8ms) << "but no longer than that: a thread may wake late";
    const auto until = drawnIn(11ms).until(kDue, kPeriod);
    ASSERT_TRUE(until);
    EXPECT_LT(*until, kDue - 12ms);
    EXPECT_GT(*until, kDue - 14ms);
}

TEST(HeldFrame, goes_at_once_if_drawing_takes_most_of_a_period) { EXPECT_FALSE(drawnIn(14ms).until(kDue, kPeriod)); }

// Example failure: every GO makes a late frame, since the cue that it enters is dearer than the one
// before.
TEST(HeldFrame, remembers_for_a_while_that_drawing_again_took_longer) {
    HeldFrame held = drawnIn(5ms);
    const Time before = *held.until(kDue, kPeriod);
    held.drawnAgain(10ms);
    EXPECT_LT(*held.until(kDue, kPeriod), before);
    held.drawnAgain(16ms);
    EXPECT_FALSE(held.until(kDue, kPeriod));
    for (int i = 0; i < 20; ++i) held.drawnAgain(5ms);
    EXPECT_TRUE(held.until(kDue, kPeriod));
}

}  // namespace
}  // namespace fantascope::app
