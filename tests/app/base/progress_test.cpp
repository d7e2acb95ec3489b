#include "app/base/progress.h"

#include <gmock/gmock.h>

#include <sstream>

namespace fantascope::app {
namespace {

using namespace std::chrono_literals;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

// A log file must not fill up with one line an iteration.
TEST(Progress, away_from_a_terminal_it_is_one_plain_line_every_two_seconds) {
    ManualClock clock;
    std::ostringstream out;
    Progress progress("pattern", clock, out, false);
    for (int tenth = 0; tenth < 50; ++tenth) {
        progress.update(tenth / 100.0, "z 0.5");
        clock.advance(100ms);
    }
    EXPECT_EQ(out.str(),
              "pattern    0 %  z 0.5\n"
              "pattern   20 %  z 0.5  8 s left\n"
              "pattern   40 %  z 0.5  6 s left\n");
}

TEST(Progress, on_a_terminal_one_line_is_drawn_over_and_ends_with_the_run) {
    ManualClock clock;
    std::ostringstream out;
    {
        Progress progress("pattern", clock, out, true, [] { return 80; });
        progress.update(0.0, "z 0.5");
        clock.advance(90s);
        progress.update(0.5, "z 0.25");
        EXPECT_THAT(out.str(), Not(HasSubstr("\n")));
    }
    EXPECT_THAT(out.str(), EndsWith("\r\x1b[Jpattern  [############............]  50 %  z 0.25  1:30 min left\r\n"));
}

TEST(Progress, a_narrow_terminal_has_no_room_for_a_bar) {
    ManualClock clock;
    std::ostringstream out;
    Progress progress("pattern", clock, out, true, [] { return 40; });
    progress.update(0.5, "z 0.25");
    EXPECT_THAT(out.str(), EndsWith("\r\x1b[Jpattern   50 %  z 0.25  0 s left\r"));
}

TEST(Progress, a_run_without_an_end_shows_the_time_that_has_passed) {
    ManualClock clock;
    std::ostringstream out;
    Progress progress("rehearse", clock, out, false);
    clock.advance(75s);
    progress.update(std::nullopt, "cue 3");
    EXPECT_EQ(out.str(), "rehearse  cue 3  1:15 min\n");
}

}  // namespace
}  // namespace fantascope::app
