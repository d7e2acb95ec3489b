// What was shown when a camera's picture was exposed.

#include "app/watch/shown_lately.h"

#include <gtest/gtest.h>

#include <functional>

namespace fantascope::app {
namespace {

using std::chrono::milliseconds;

// 1 until a second has passed, then 2. `step`: between notes.
ShownLately<int> change(Time step, Time until = std::chrono::seconds(3)) {
    ShownLately<int> shown;
    for (Time at{}; at <= until; at += step) shown.note(at, at < milliseconds(1000) ? 1 : 2);
    return shown;
}

TEST(ShownLately, knows_what_was_shown_at_a_time) {
    const ShownLately<int> shown = change(milliseconds(200));
    EXPECT_EQ(shown.at(milliseconds(-50)), 1) << "the oldest";
    EXPECT_EQ(shown.at(milliseconds(999)), 1);
    EXPECT_EQ(shown.at(milliseconds(1000)), 2);
    EXPECT_EQ(shown.at(milliseconds(9000)), 2);
    EXPECT_EQ(change(milliseconds(200), std::chrono::seconds(30)).at(milliseconds(500)), 2) << "that long ago is forgotten";
}

TEST(ShownLately, is_not_steady_about_a_change) {
    const ShownLately<int> shown = change(milliseconds(50));
    const auto isSteady = [&](int at) { return shown.isSteady(milliseconds(at), std::equal_to<>()); };
    EXPECT_TRUE(isSteady(300));
    EXPECT_FALSE(isSteady(450));
    EXPECT_FALSE(isSteady(1500));
    EXPECT_TRUE(isSteady(1700));
}

// Example failure: a change between two notes, of which the first is long before the picture,
// counts as none.
TEST(ShownLately, is_not_steady_while_a_change_may_just_have_been) {
    const ShownLately<int> shown = change(milliseconds(900));  // 2 is noted at 1.8 s
    const auto isSteady = [&](int at) { return shown.isSteady(milliseconds(at), std::equal_to<>()); };
    EXPECT_TRUE(isSteady(1000));
    EXPECT_FALSE(isSteady(1850));
    EXPECT_FALSE(isSteady(2350));
    EXPECT_TRUE(isSteady(2450));
}

}  // namespace
}  // namespace fantascope::app
