#include "drivers/cue_controller/button_events.h"

#include "core/random.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

namespace fantascope::drivers {
namespace {

using namespace std::chrono_literals;
using enum ButtonChange::What;

class ButtonEventsTest : public testing::Test {
protected:
    void change(int button, ButtonChange::What what, Time now) { events_.feed({{button, what}}, now); }
    // "+3@5": button 3 down at 5 ms.
    std::string given() {
        std::string all;
        while (const auto event = events_.poll())
            all += fmt::format("{}{}@{} ", event->pressed ? '+' : '-', event->button, event->at / 1ms);
        return all;
    }
    ButtonEvents events_{5ms};
};

TEST_F(ButtonEventsTest, a_press_is_never_held_back) {
    change(1, Down, 100ms);
    EXPECT_EQ(given(), "+1@100 ");
}

TEST_F(ButtonEventsTest, a_press_that_bounces_is_one_press_until_the_finger_goes) {
    for (const auto& [what, at] : {std::pair(Down, 100ms), {Up, 101ms}, {Down, 102ms}, {Up, 103ms}, {Down, 104ms}})
        change(1, what, at);
    events_.flush(200ms);
    EXPECT_EQ(given(), "+1@100 ");
    for (const auto& [what, at] : {std::pair(Up, 500ms), {Down, 501ms}, {Up, 502ms}}) change(1, what, at);
    events_.flush(600ms);
    EXPECT_EQ(given(), "-1@500 ");
}

TEST_F(ButtonEventsTest, a_tap_that_is_shorter_than_the_debounce_is_let_go_at_its_end) {
    change(1, Down, 100ms);
    change(1, Up, 102ms);
    EXPECT_EQ(events_.nextFlush(), 105ms);
    events_.flush(104ms);
    EXPECT_EQ(given(), "+1@100 ");
    events_.flush(105ms);
    EXPECT_EQ(given(), "-1@105 ");
    EXPECT_EQ(events_.nextFlush(), std::nullopt);
}

TEST_F(ButtonEventsTest, what_was_held_back_comes_out_in_its_order) {
    change(3, Down, 100ms);
    change(1, Down, 101ms);
    change(1, Up, 102ms);
    change(3, Up, 103ms);
    events_.flush(106ms);
    EXPECT_EQ(given(), "+3@100 +1@101 -1@106 -3@106 ");
}

// Two releases within the debounce time of the later press.
TEST_F(ButtonEventsTest, no_release_overtakes_one_that_is_held_back) {
    change(3, Down, 100ms);
    change(1, Down, 104ms);
    change(1, Up, 105ms);
    change(3, Up, 106ms);
    change(2, Down, 107ms);
    events_.flush(109ms);
    EXPECT_EQ(given(), "+3@100 +1@104 +2@107 -1@109 -3@109 ");
}

TEST_F(ButtonEventsTest, buttons_do_not_hold_each_other_back) {
    change(1, Down, 100ms);
    change(2, Down, 101ms);
    EXPECT_EQ(given(), "+1@100 +2@101 ");
}

TEST_F(ButtonEventsTest, a_detent_is_a_press_and_a_release_however_fast) {
    for (int i = 0; i < 3; ++i) change(6, Detent, 100ms);
    EXPECT_EQ(given(), "+6@100 -6@100 +6@100 -6@100 +6@100 -6@100 ");
}

TEST_F(ButtonEventsTest, what_was_down_before_is_no_press_and_no_release) {
    events_.setInitial({{1, Down}, {2, Down}, {2, Up}, {9, Detent}});
    change(1, Up, 100ms);
    change(1, Down, 101ms);  // a release bounces
    change(1, Up, 102ms);
    events_.flush(200ms);
    EXPECT_EQ(given(), "");
    change(1, Down, 300ms);
    change(2, Down, 301ms);
    EXPECT_EQ(given(), "+1@300 +2@301 ");
}

TEST_F(ButtonEventsTest, a_loss_lets_go_of_what_was_polled_and_forgets_the_rest) {
    change(1, Down, 100ms);
    change(2, Down, 100ms);
    EXPECT_EQ(given(), "+1@100 +2@100 ");
    change(2, Up, 150ms);
    change(3, Down, 150ms);
    events_.deviceLost(200ms);
    events_.deviceLost(300ms);
    EXPECT_EQ(given(), "-1@300 -2@300 ");
    change(1, Down, 400ms);
    EXPECT_EQ(given(), "+1@400 ");
}

// Nobody polls: presses that come out hours later would start unwanted cues.
TEST_F(ButtonEventsTest, presses_that_nobody_polls_are_dropped_with_their_releases) {
    for (int i = 0; i < 5000; ++i) {
        change(1, Down, i * 100ms);
        change(1, Up, i * 100ms + 50ms);
    }
    int events = 0;
    bool down = false;
    while (const auto event = events_.poll()) {
        EXPECT_NE(event->pressed, down);
        down = event->pressed;
        ++events;
    }
    EXPECT_FALSE(down);
    EXPECT_LE(events, static_cast<int>(ButtonEvents::kMaxWaiting) + 1);
}

// Whatever the contacts do, the events of a button alternate, a press first, and end in the
// contact's state.
TEST_F(ButtonEventsTest, alternate_in_any_weather) {
    Rng rng(7);
    Time now{};
    std::map<int, bool> contact, told;
    for (int i = 0; i < 20'000; ++i) {
        now += fromSeconds(rng.uniform(0, 0.01));
        const int button = static_cast<int>(rng.below(4)) + 1;
        contact[button] = !contact[button];
        change(button, contact[button] ? Down : Up, now);
        if (rng.below(500) == 0) {
            events_.deviceLost(now);
            contact.clear();
        }
        while (const auto event = events_.poll()) {
            EXPECT_NE(event->pressed, told[event->button]);
            told[event->button] = event->pressed;
        }
    }
    events_.flush(now + 1s);
    while (const auto event = events_.poll()) told[event->button] = event->pressed;
    for (const auto& [button, down] : contact) EXPECT_EQ(told[button], down) << button;
}

}  // namespace
}  // namespace fantascope::drivers
