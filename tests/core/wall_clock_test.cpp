// A schedule says "at half past nine in the evening": by the clocks of the place, in summer and in
// winter.

#include "core/wall_clock.h"

#include <gmock/gmock.h>

#include <cstdlib>
#include <optional>
#include <string>

namespace fantascope {
namespace {

using namespace std::chrono_literals;
using std::chrono::sys_days;

// The environment's zone for as long as it lives.
class Zone {
public:
    explicit Zone(const char* zone) {
        if (const char* const before = std::getenv("TZ")) before_ = before;
        ::setenv("TZ", zone, 1);
    }
    ~Zone() { before_ ? ::setenv("TZ", before_->c_str(), 1) : ::unsetenv("TZ"); }

private:
    std::optional<std::string> before_;
};

// By POSIX rules, so that the machine needs no table of zones.
constexpr const char* kBerlin = "CET-1CEST,M3.5.0,M10.5.0/3";

Time utcOf(std::chrono::year_month_day date, Time timeOfDay) {
    return std::chrono::duration_cast<Time>(sys_days(date).time_since_epoch()) + timeOfDay;
}

TEST(WallTime, has_the_date_and_the_time_of_day_of_its_place) {
    const WallTime time = wallTimeOf(utcOf(2026y / 7 / 31, 22h + 30min + 1ns), 2h);
    EXPECT_EQ(time.date, 2026y / 8 / 1) << "there it is tomorrow";
    EXPECT_EQ(time.timeOfDay, 30min + 1ns);
    EXPECT_EQ(wallTimeOf(utcOf(2026y / 3 / 1, 1h), -5h).date, 2026y / 2 / 28);
    EXPECT_EQ(wallTimeOf(utcOf(1969y / 12 / 31, 23h), 0h), (WallTime{-1h, 0h, 1969y / 12 / 31, 23h})) << "before the epoch, too";
}

TEST(WallTime, of_this_machine_follows_its_zone) {
    const Time utc = utcOf(2026y / 1 / 15, 20h + 30min + 250ms);
    const auto in = [&](const char* zone) {
        const Zone here(zone);
        return localTimeOf(utc);
    };
    EXPECT_EQ(in("UTC0"), (WallTime{utc, 0h, 2026y / 1 / 15, 20h + 30min + 250ms}));
    EXPECT_EQ(in(kBerlin), (WallTime{utc, 1h, 2026y / 1 / 15, 21h + 30min + 250ms}));
    EXPECT_EQ(in("<+0545>-5:45"), (WallTime{utc, 5h + 45min, 2026y / 1 / 16, 2h + 15min + 250ms}));
    EXPECT_EQ(in("EST5"), (WallTime{utc, -5h, 2026y / 1 / 15, 15h + 30min + 250ms}));
}

// In the night to 2026-03-29 the clocks go from 2 to 3, in that to 2026-10-25 from 3 back to 2.
// Example failure: a show that ends at 2:30 ends an hour late, because the offset was asked for
// once, in the evening.
TEST(WallTime, of_this_machine_changes_to_summer_time_and_back) {
    const Zone berlin(kBerlin);
    const Time spring = utcOf(2026y / 3 / 29, 1h), autumn = utcOf(2026y / 10 / 25, 1h);
    EXPECT_EQ(localTimeOf(spring - 1ns).timeOfDay, 2h - 1ns);
    EXPECT_EQ(localTimeOf(spring).timeOfDay, 3h);
    EXPECT_EQ(localTimeOf(spring).offset, 2h);
    EXPECT_EQ(localTimeOf(autumn - 1ns).timeOfDay, 3h - 1ns);
    EXPECT_EQ(localTimeOf(autumn).timeOfDay, 2h) << "this hour comes twice; the offset tells which one it is";
    EXPECT_EQ(localTimeOf(autumn).offset, 1h);
}

TEST(WallClock, of_the_system_never_lags_behind_a_moment_that_was_seen_before) {
    const Time before = std::chrono::duration_cast<Time>(std::chrono::system_clock::now().time_since_epoch());
    const WallTime now = SystemWallClock().now();
    EXPECT_GE(now.utc, before);
    EXPECT_EQ(now, localTimeOf(now.utc));
}

TEST(WallClock, of_a_test_shows_what_it_was_set_to) {
    ManualWallClock clock;
    EXPECT_EQ(clock.now().date, 1970y / 1 / 1);
    clock.set(utcOf(2026y / 6 / 24, 19h + 30min), 2h);
    EXPECT_EQ(clock.now().date, 2026y / 6 / 24);
    EXPECT_EQ(clock.now().timeOfDay, 21h + 30min);
}

}  // namespace
}  // namespace fantascope
