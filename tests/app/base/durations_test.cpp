#include "app/base/durations.h"

#include <gmock/gmock.h>

namespace fantascope::app {
namespace {

using namespace std::chrono_literals;

TEST(Durations, quantiles_are_those_of_the_nearest_rank_within_one_percent) {
    Durations durations;
    for (int i = 100; i >= 1; --i) durations.add(i * 1ms);
    EXPECT_EQ(durations.count(), 100u);
    EXPECT_NEAR(durations.quantileMs(0.5), 50, 0.5);
    EXPECT_NEAR(durations.quantileMs(0.99), 99, 0.99);
    EXPECT_EQ(durations.maxMs(), 100);
}

TEST(Durations, nothing_and_the_extremes_are_safe) {
    Durations durations;
    EXPECT_EQ(durations.quantileMs(0.5), 0);
    durations.add(0ns);
    durations.add(10h);
    EXPECT_LE(durations.quantileMs(0.5), 0.00101);  // a microsecond is the least, within 1 %
    EXPECT_EQ(durations.maxMs(), 36e6);
}

}  // namespace
}  // namespace fantascope::app
