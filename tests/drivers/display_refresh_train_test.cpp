#include "drivers/display/refresh_train.h"

#include <gtest/gtest.h>

namespace fantascope::drivers {
namespace {

constexpr double kHertz = 50;  // a period of 20 ms

Time milliseconds(double count) { return fromSeconds(count / 1000); }

TEST(RefreshTrain, counts_by_the_clock_until_a_refresh_is_seen) {
    const RefreshTrain train(kHertz);
    EXPECT_EQ(train.running(milliseconds(0)), 0);
    EXPECT_EQ(train.running(milliseconds(19.9)), 0);
    EXPECT_EQ(train.running(milliseconds(60)), 3);
    EXPECT_EQ(train.timeOf(3), milliseconds(60));
}

// The monitor's refreshes lie between the clock's and drift relative to them.
TEST(RefreshTrain, follows_the_refreshes_that_are_seen) {
    RefreshTrain train(kHertz);
    EXPECT_EQ(train.seen(milliseconds(67)), 3);
    EXPECT_EQ(train.timeOf(4), milliseconds(87));
    EXPECT_EQ(train.running(milliseconds(86)), 3);
    EXPECT_EQ(train.running(milliseconds(87)), 4);
    for (int refresh = 4; refresh < 100; ++refresh) EXPECT_EQ(train.seen(milliseconds(67 + 20.2 * (refresh - 3))), refresh);
}

// Example failure: a late frame gets the number of the refresh that it missed, and nobody notices.
TEST(RefreshTrain, counts_the_refreshes_that_nobody_saw) {
    RefreshTrain train(kHertz);
    train.seen(milliseconds(67));
    EXPECT_EQ(train.seen(milliseconds(67 + 3 * 20 + 1)), 6);
}

// Two frames cannot share a refresh, because the display waited between them.
TEST(RefreshTrain, gives_no_number_twice) {
    RefreshTrain train(kHertz);
    const auto first = train.seen(milliseconds(67));
    EXPECT_EQ(train.seen(milliseconds(67 + 6)), first + 1);
}

}  // namespace
}  // namespace fantascope::drivers
