// A person's keys at a window arrive in their order, and none is lost without a word.

#include "drivers/display/screen_events.h"

#include <gmock/gmock.h>

#include <vector>

namespace fantascope::drivers {
namespace {

using namespace std::chrono_literals;
using Kind = ScreenEvent::Kind;

ScreenEvent key(char letter, Time moment = {}) { return {Kind::KeyDown, {.letter = letter}, {}, moment}; }
ScreenEvent move(double x) { return {Kind::PointerMoved, {}, {x, 0}, {}}; }

TEST(ScreenEvents, of_moves_on_end_the_newest_arrives_and_before_whatever_follows) {
    ScreenEvents events;
    for (int x = 0; x < 10'000; ++x) events.give(move(x));
    events.give({Kind::ButtonUp, {}, {9'999, 0}, {}});
    for (int x = 0; x < 10; ++x) events.give(move(x));
    EXPECT_EQ(events.take()->at.x, 9'999);
    EXPECT_EQ(events.take()->kind, Kind::ButtonUp);
    EXPECT_FALSE(events.take()) << "more moves may come";
    events.flush();
    events.flush();
    EXPECT_EQ(events.take()->at.x, 9);
    EXPECT_FALSE(events.take());
}

// Example failure: somebody presses keys while the program works out a blend, and some do nothing.
TEST(ScreenEvents, that_find_no_room_are_known_as_lost) {
    ScreenEvents events;
    for (int i = 0; i < static_cast<int>(ScreenEvents::kMost); ++i) events.give(key('a', Time(i)));
    events.give(move(7));
    events.flush();
    EXPECT_EQ(events.lastLost(), std::nullopt) << "all have come so far, and a move can wait";
    events.give(key('b', 5s));
    EXPECT_EQ(events.lastLost(), 5s);
    for (int i = 0; i < static_cast<int>(ScreenEvents::kMost); ++i) EXPECT_EQ(events.take()->moment, Time(i));
    EXPECT_FALSE(events.take());
    events.give(key('c'));
    EXPECT_EQ(events.take()->kind, Kind::PointerMoved);
    EXPECT_EQ(events.take()->key.letter, 'c');
}

}  // namespace
}  // namespace fantascope::drivers
