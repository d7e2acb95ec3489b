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

// Example failure: every GO makes a late frame, since the fade that it begins is dearer than what
// was seen before.
TEST(HeldFrame, remembers_for_a_while_what_a_fade_took) {
    HeldFrame held = drawnIn(7ms);
    const Time before = *held.until(kDue, kPeriod);
    for (int i = 0; i < 10; ++i) held.drawn(14ms);
    for (int i = 0; i < 100; ++i) held.drawn(7ms);
    EXPECT_FALSE(held.until(kDue, kPeriod));
    for (int i = 0; i < 3000; ++i) held.drawn(7ms);
    EXPECT_NEAR(seconds(*held.until(kDue, kPeriod)), seconds(before), 1e-4);
}

// Example failure: a machine that stands still for a moment makes every press late for seconds.
TEST(HeldFrame, soon_forgets_that_the_machine_stood_still) {
    HeldFrame held = drawnIn(3ms);
    held.drawn(70ms);
    for (int i = 0; i < 30; ++i) held.drawn(3ms);
    EXPECT_TRUE(held.until(kDue, kPeriod));
}

}  // namespace
}  // namespace fantascope::app
