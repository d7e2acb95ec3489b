#include "app/base/attendance.h"

#include <gtest/gtest.h>

#include <csignal>
#include <deque>

namespace fantascope::app {
namespace {

// Keys that come one at each look.
Attendance::Listen typed(std::deque<std::optional<char>> keys) {
    return [keys = std::move(keys)]() mutable -> std::optional<char> {
        if (keys.empty()) return std::nullopt;
        const auto key = keys.front();
        keys.pop_front();
        return key;
    };
}

TEST(Attendance, goes_on_while_nobody_says_anything) {
    ManualClock clock;
    Attendance attendance(clock);
    EXPECT_TRUE(attendance.goesOn());
    EXPECT_EQ(attendance.paused(), Time{});
}

// Example failure: the time that work stands still is taken off its budget.
TEST(Attendance, stands_still_between_two_spaces_and_says_for_how_long) {
    ManualClock clock;
    Attendance attendance(clock, typed({' ', std::nullopt, std::nullopt, std::nullopt, ' ', std::nullopt}));
    const Time start = clock.now();
    int told = 0;
    EXPECT_TRUE(attendance.goesOn([&] { ++told; }));
    EXPECT_GT(told, 1);
    EXPECT_GT(attendance.paused(), Time{});
    EXPECT_EQ(attendance.paused(), clock.now() - start);
    EXPECT_TRUE(attendance.goesOn());
    EXPECT_EQ(attendance.paused(), clock.now() - start);
}

TEST(Attendance, ends_at_escape_and_q_while_paused_too) {
    ManualClock clock;
    EXPECT_FALSE(Attendance(clock, typed({'\x1b'})).goesOn());
    EXPECT_FALSE(Attendance(clock, typed({'x', 'q'})).goesOn());
    EXPECT_FALSE(Attendance(clock, typed({' ', std::nullopt, '\x1b'})).goesOn());
}

TEST(Attendance, ends_at_ctrl_c_while_paused_too) {
    ManualClock clock;
    Attendance attendance(clock, typed({' '}));
    EXPECT_FALSE(attendance.goesOn([] { std::raise(SIGINT); }));
}

}  // namespace
}  // namespace fantascope::app
