#include "show/course/wind.h"

#include "core/geometry.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace fantascope::show {
namespace {

using namespace std::chrono_literals;

const WindCourse kUsual{WindWish()};

TEST(WindCourse, is_what_is_asked_for_once_that_has_come) {
    const WindCourse course(kUsual, {2.5, 0, radians(30)}, 10s, 4s);
    const Wind before = course.at(10s, 0), after = course.at(60s, 0);
    EXPECT_EQ(before, Wind{});
    EXPECT_DOUBLE_EQ(after.strength, 2.5);
    EXPECT_NEAR(after.ownDirection, 0, 1e-15);
    EXPECT_DOUBLE_EQ(after.direction.x, std::cos(radians(30)));
    EXPECT_DOUBLE_EQ(after.direction.y, std::sin(radians(30)));
}

// Both lags in small steps, without the closed form: first' = (asked - first) / lag, second' =
// (first - second) / lag.
TEST(WindCourse, follows_a_fade_through_two_lags_of_half_a_second) {
    for (const double fade : {0.0, 3.0}) {
        const WindCourse course(kUsual, {4, 0, std::nullopt}, 0s, fromSeconds(fade));
        constexpr double kStep = 1e-5, kLag = 0.5;
        double first = 1, second = 1;
        for (int i = 0; i < 600'000; ++i) {
            const double time = i * kStep;
            if (i % 50'000 == 0) {
                EXPECT_NEAR(course.at(fromSeconds(time), 0).strength, second, 1e-4) << "fade " << fade << " at " << time;
            }
            const double asked = time < fade ? 1 + 3 * time / fade : 4;
            second += kStep * (first - second) / kLag;
            first += kStep * (asked - first) / kLag;
        }
    }
}

// Example failure: from the strength that was asked for, or with the lags begun anew, which jerks.
TEST(WindCourse, left_in_the_middle_goes_on_from_there) {
    const WindCourse first(kUsual, {4, 0, std::nullopt}, 0s, 4s);
    const WindCourse second(first, {0, 0, std::nullopt}, 1s, 2s);
    EXPECT_NEAR(second.at(1s, 0).strength, first.at(1s, 0).strength, 1e-15);
    EXPECT_NEAR(second.at(1001ms, 0).strength, first.at(1001ms, 0).strength, 1e-5);
    // Nobody tells that it was left for what it goes to anyway.
    const WindCourse same(first, {4, 0, std::nullopt}, 1s, 3s);
    for (const Time time : {1s, 2s, 4s, 5s, 9s}) EXPECT_NEAR(same.at(time, 0).strength, first.at(time, 0).strength, 1e-12);
}

// From 359 to 1 degrees it is two degrees. Example failure: the angle runs down through 180.
TEST(WindCourse, turns_the_short_way) {
    const WindCourse west({1, 0, radians(359)});
    const WindCourse course(west, {1, 0, radians(1)}, 0s, 5s);
    for (Time time{}; time < 10s; time += 100ms) {
        const Wind wind = course.at(time, 0);
        EXPECT_GT(wind.direction.x, 0.999);
        EXPECT_LT(std::abs(wind.direction.y), std::sin(radians(1)) + 1e-12);
    }
}

TEST(WindCourse, comes_from_the_other_side_by_dying_down) {
    const WindCourse east({1, 0, 0.0});
    const WindCourse course(east, {1, 0, radians(180)}, 0s, 4s);
    double least = 1;
    for (Time time{}; time < 12s; time += 10ms) {
        const Wind wind = course.at(time, 0);
        least = std::min(least, std::abs(wind.direction.x));
        EXPECT_LT(std::abs(wind.direction.y), 1e-12);
    }
    EXPECT_LT(least, 0.01);
}

TEST(WindCourse, strength_is_that_of_the_strongest_gust) {
    const WindCourse gusty({2, 0.6, std::nullopt});
    EXPECT_DOUBLE_EQ(gusty.at(0s, 0).strength, 2);
    EXPECT_DOUBLE_EQ(gusty.at(0s, 1).strength, 0.8);
}

TEST(Gusts, come_and_go_smoothly_for_days) {
    const Gusts gusts(1);
    for (const Time start : {Time{-1h}, Time{0s}, Time{100h}}) {
        double least = 1, most = 0;
        for (Time time = start; time < start + 5min; time += 20ms) {
            const double lull = gusts.lullAt(time), next = gusts.lullAt(time + 20ms);
            ASSERT_TRUE(lull >= 0 && lull <= 1);
            ASSERT_LT(std::abs(next - lull), 0.02);  // a whole one takes a second at least
            least = std::min(least, lull);
            most = std::max(most, lull);
        }
        EXPECT_LT(least, 0.2);
        EXPECT_GT(most, 0.8);
    }
}

TEST(Gusts, have_no_period_and_a_stream_of_their_own) {
    const Gusts gusts(1), others(2);
    double apart = 0, seeds = 0;
    for (Time time{}; time < 10min; time += 1s) {
        apart = std::max(apart, std::abs(gusts.lullAt(time) - gusts.lullAt(time + 20s)));
        seeds = std::max(seeds, std::abs(gusts.lullAt(time) - others.lullAt(time)));
    }
    EXPECT_GT(apart, 0.3);
    EXPECT_GT(seeds, 0.3);
    EXPECT_EQ(Gusts(1).lullAt(77s), gusts.lullAt(77s));
}

}  // namespace
}  // namespace fantascope::show
