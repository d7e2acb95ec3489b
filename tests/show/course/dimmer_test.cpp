#include "show/course/dimmer.h"

#include <gtest/gtest.h>

namespace fantascope::show {
namespace {

using namespace std::chrono_literals;

TEST(Dimmer, gives_full_light_until_something_else_is_wanted) {
    const Dimmer dimmer;
    EXPECT_EQ(dimmer.at(-1h), 1);
    EXPECT_EQ(dimmer.wantedAt(1h), 1);
}

TEST(Dimmer, moves_at_a_constant_rate_and_turns_without_a_step) {
    Dimmer dimmer;
    dimmer.want(0, 10s, 4s);
    EXPECT_FLOAT_EQ(dimmer.at(11s), 0.75f);
    dimmer.want(1, 12s, 4s);
    EXPECT_FLOAT_EQ(dimmer.at(12s), 0.5f);
    EXPECT_FLOAT_EQ(dimmer.at(13s), 0.75f);
    EXPECT_EQ(dimmer.at(14s), 1);
    EXPECT_FLOAT_EQ(dimmer.at(11s), 0.75f) << "the past does not change";
}

TEST(Dimmer, stops_at_the_level_that_is_wanted) {
    Dimmer dimmer;
    dimmer.want(0.7f, 0s, 10s);
    EXPECT_FLOAT_EQ(dimmer.at(2s), 0.8f);
    EXPECT_EQ(dimmer.at(3s), 0.7f);
    EXPECT_EQ(dimmer.at(9s), 0.7f);
    EXPECT_EQ(dimmer.wantedAt(1s), 0.7f);
}

TEST(Dimmer, is_there_at_once_without_a_fade) {
    Dimmer dimmer;
    dimmer.want(0, 5s, 0s);
    EXPECT_EQ(dimmer.at(5s), 0);
}

}  // namespace
}  // namespace fantascope::show
