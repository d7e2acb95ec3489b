#include "app/calibrate/picture_schedule.h"

#include <gtest/gtest.h>

#include <map>

namespace fantascope::app {
namespace {

using std::chrono::milliseconds;

constexpr Time kPeriod = milliseconds(100);

// Example failure: a picture counts for the frame during whose exposure it came.
TEST(PictureSchedule, gives_no_picture_to_a_frame_that_may_have_seen_two) {
    PictureSchedule schedule({milliseconds(190), milliseconds(210)}, kPeriod);
    schedule.show(7, milliseconds(1000));
    schedule.show(8, milliseconds(1500));
    // Seen from 1190 - 1210 to 1690 - 1710; an exposure lasts from half a period before its stamp
    // to a whole one after it.
    EXPECT_FALSE(schedule.pictureOf(milliseconds(1259)));
    EXPECT_EQ(schedule.pictureOf(milliseconds(1260)), 7);
    EXPECT_EQ(schedule.pictureOf(milliseconds(1590)), 7);
    EXPECT_FALSE(schedule.pictureOf(milliseconds(1591)));
    EXPECT_FALSE(schedule.pictureOf(milliseconds(1759)));
    EXPECT_EQ(schedule.pictureOf(milliseconds(1760)), 8) << "until another is shown";
    EXPECT_EQ(schedule.pictureOf(milliseconds(9000)), 8);
}

// Whatever the camera's phase, a picture that is shown for its dwell gets its frames.
TEST(PictureSchedule, a_dwell_is_long_enough_for_the_frames) {
    for (const int frames : {1, 3})
        for (int phase = 0; phase < 100; phase += 7) {
            PictureSchedule schedule({milliseconds(30), milliseconds(55)}, kPeriod);
            Time from = milliseconds(500);
            for (int picture = 0; picture < 5; ++picture, from += schedule.dwell(frames)) schedule.show(picture, from);
            schedule.show(-1, from);
            std::map<std::int64_t, int> seen;
            for (Time exposed = milliseconds(phase); exposed < from; exposed += kPeriod)
                if (const auto picture = schedule.pictureOf(exposed)) ++seen[*picture];
            for (int picture = 0; picture < 5; ++picture) EXPECT_GE(seen[picture], frames) << phase;
        }
}

}  // namespace
}  // namespace fantascope::app
