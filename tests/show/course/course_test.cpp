#include "show/course/course.h"

#include <gmock/gmock.h>

namespace fantascope::show {
namespace {

using namespace std::chrono_literals;

TEST(Course, goes_from_one_value_to_another_in_its_time) {
    const Course course{0.2f, 1, 10s, 4s};
    EXPECT_EQ(course.valueAt(3s), 0.2f);
    EXPECT_EQ(course.valueAt(10s), 0.2f);
    EXPECT_FLOAT_EQ(course.valueAt(11s), 0.4f);
    EXPECT_EQ(course.valueAt(14s), 1);
    EXPECT_EQ(course.valueAt(10h), 1);
    EXPECT_EQ(Course::at(0.3f).valueAt(-5s), 0.3f);
}

TEST(Course, without_a_length_jumps_at_its_start) {
    const Course cut{1, 0, 2s, 0s};
    EXPECT_EQ(cut.valueAt(2s - 1ns), 1);
    EXPECT_EQ(cut.valueAt(2s), 0);
}

// Example failure: a lamp that is to begin gently begins with a step in its rate.
TEST(Course, that_is_smooth_begins_and_ends_at_rest_and_is_half_way_at_half_time) {
    const Course course{0, 1, 0s, 2s, Curve::Smooth};
    EXPECT_LT(course.valueAt(20ms), 0.0004f);
    EXPECT_GT(course.valueAt(1980ms), 0.9996f);
    EXPECT_FLOAT_EQ(course.valueAt(1s), 0.5f);
    EXPECT_FLOAT_EQ(course.valueAt(500ms), 0.15625f);
    for (Time time = 0s; time < 2s; time += 10ms) EXPECT_LE(course.valueAt(time), course.valueAt(time + 10ms));
}

}  // namespace
}  // namespace fantascope::show
