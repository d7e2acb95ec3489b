#include "show/course/cue_time.h"

#include <gtest/gtest.h>

namespace fantascope::show {
namespace {

using namespace std::chrono_literals;

TEST(CueTime, is_show_time_until_it_stands_still) {
    CueTime cueTime;
    EXPECT_EQ(cueTime.at(-5s), -5s);
    cueTime.stand(10s);
    EXPECT_EQ(cueTime.at(9s), 9s);
    EXPECT_EQ(cueTime.at(10s), 10s);
    EXPECT_EQ(cueTime.at(1h), 10s);
    EXPECT_FALSE(cueTime.standsAt(9s));
    EXPECT_TRUE(cueTime.standsAt(10s));
}

TEST(CueTime, goes_on_from_where_it_stood_with_the_next_nanosecond) {
    CueTime cueTime;
    cueTime.stand(10s);
    cueTime.stand(12s);
    cueTime.goOn(15s);
    cueTime.goOn(16s);
    EXPECT_EQ(cueTime.at(15s - 1ns), 10s);
    EXPECT_EQ(cueTime.at(15s), 10s + 1ns);
    EXPECT_EQ(cueTime.at(18s), 13s + 1ns);
    cueTime.stand(20s);
    EXPECT_EQ(cueTime.at(30s), 15s + 1ns);
}

TEST(CueTime, ticks_only_while_it_stands) {
    CueTime cueTime;
    cueTime.tick(5s);
    EXPECT_EQ(cueTime.at(6s), 6s);
    cueTime.stand(10s);
    cueTime.tick(12s);
    EXPECT_EQ(cueTime.at(11s), 10s);
    EXPECT_EQ(cueTime.at(13s), 10s + 1ns);
    EXPECT_TRUE(cueTime.standsAt(13s));
}

TEST(CueTime, forgets_what_was_and_keeps_what_is) {
    CueTime cueTime;
    for (int i = 0; i < 100; ++i) {
        cueTime.stand(i * 2s);
        cueTime.goOn(i * 2s + 1s);
    }
    const Time before = cueTime.at(300s);
    cueTime.forget(150s);
    EXPECT_EQ(cueTime.at(300s), before);
    EXPECT_TRUE(cueTime.standsAt(150s + 500ms));
}

}  // namespace
}  // namespace fantascope::show
