#include "show/course/play_course.h"

#include <gtest/gtest.h>

#include <vector>

namespace fantascope::show {
namespace {

using namespace std::chrono_literals;

const std::vector<Curve> kCurves = {Curve::Linear, Curve::Smooth, Curve::SlowStart, Curve::SlowEnd};

TEST(PlayCourse, is_cue_time_until_the_speed_changes) {
    const PlayCourse course;
    EXPECT_EQ(course.behindAt(-5s), 0s);
    EXPECT_EQ(course.behindAt(720h), 0s);
    EXPECT_EQ(course.moved(0.5f, 10s, 2s, Curve::Linear).behindAt(10s), 0s);
}

// Example failure: the own time jumps by what the change of speed has cost.
TEST(PlayCourse, own_time_is_the_integral_of_the_speed) {
    for (const Curve curve : kCurves) {
        const PlayCourse course = PlayCourse().at(2, 0s).moved(0.25f, 3s, 4s, curve);
        double played = 6;  // in the first three seconds
        constexpr Time kStep = 1ms;
        for (Time time = 3s; time < 9s; time += kStep) {
            EXPECT_NEAR(seconds(course.ownTime(time)), played, 1e-5) << seconds(time);
            played += seconds(kStep) * static_cast<double>(course.speedAt(time + kStep / 2));
        }
    }
}

TEST(PlayCourse, back_at_the_usual_speed_the_difference_stays_the_same) {
    const PlayCourse course = PlayCourse().moved(0, 1s, 3s, Curve::Smooth).moved(1, 9s, 2s, Curve::SlowEnd);
    const Time behind = course.behindAt(11s);
    EXPECT_GT(behind, 5s);
    EXPECT_EQ(course.behindAt(11s + 1ns), behind);
    EXPECT_EQ(course.behindAt(720h), behind);
}

TEST(PlayCourse, a_source_that_joins_late_plays_as_if_the_speed_had_always_been) {
    const PlayCourse course = PlayCourse().at(0.5f, 10s);
    EXPECT_EQ(course.ownTime(10s) - course.ownTime(4s), 3s);
}

TEST(PlayCourse, knows_when_an_own_time_comes) {
    for (const Curve curve : kCurves) {
        const PlayCourse course = PlayCourse().moved(3, 2s, 4s, curve).moved(0.5f, 8s, 2s, curve);
        for (Time time = 8s; time < 20s; time += 700ms) {
            const auto found = course.whenIs(course.ownTime(time), 8s);
            ASSERT_TRUE(found);
            EXPECT_NEAR(seconds(*found), seconds(time), 1e-6) << seconds(time);
        }
        EXPECT_EQ(course.whenIs(course.ownTime(7s), 9s), 9s) << "it is over";
    }
}

TEST(PlayCourse, what_comes_to_stand_does_not_get_there) {
    const PlayCourse course = PlayCourse().moved(0, 10s, 2s, Curve::Linear);  // it plays for one more second
    EXPECT_EQ(course.whenIs(11s + 1ms, 10s), std::nullopt);
    EXPECT_NEAR(seconds(course.whenIs(10s + 750ms, 10s).value()), 11, 1e-6);
}

}  // namespace
}  // namespace fantascope::show
