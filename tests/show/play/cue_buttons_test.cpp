#include "show/play/cue_buttons.h"

#include <gmock/gmock.h>

namespace fantascope::show {
namespace {

using namespace std::chrono_literals;

const std::vector<SiteButton> kButtons = {{1, Button::Go}, {2, Button::Back}, {7, Button::Blackout}};

TEST(CueButtons, each_button_asks_for_what_the_site_says) {
    CueButtons buttons(kButtons);
    EXPECT_EQ(buttons.inputFor(1, true, 5s)->kind, Input::Kind::Go);
    EXPECT_EQ(buttons.inputFor(2, true, 6s)->kind, Input::Kind::Back);
    EXPECT_EQ(buttons.inputFor(7, true, 7s)->kind, Input::Kind::Blackout);
    EXPECT_FALSE(buttons.inputFor(3, true, 8s));
    EXPECT_EQ(CueButtons(kButtons).inputFor(1, true, 5s)->at, 5s);
}

// A finger that stays on the button, or a driver that repeats the press, must not run through the
// cues.
// Example failure: GO again with every repeat.
TEST(CueButtons, a_button_must_be_let_go_of_before_it_counts_again) {
    CueButtons buttons(kButtons);
    EXPECT_TRUE(buttons.inputFor(1, true, 1s));
    EXPECT_FALSE(buttons.inputFor(1, true, 2s));
    EXPECT_FALSE(buttons.inputFor(1, true, 3s));
    EXPECT_FALSE(buttons.inputFor(1, false, 4s));
    EXPECT_TRUE(buttons.inputFor(1, true, 5s));
}

// Each button has its own finger: the blackout works while GO is held.
TEST(CueButtons, a_held_button_does_not_block_the_others) {
    CueButtons buttons(kButtons);
    EXPECT_TRUE(buttons.inputFor(1, true, 1s));
    EXPECT_TRUE(buttons.inputFor(7, true, 2s));
    EXPECT_FALSE(buttons.inputFor(7, false, 3s));
    EXPECT_FALSE(buttons.inputFor(1, true, 4s));
}

TEST(CueButtons, a_release_without_a_press_does_nothing) {
    CueButtons buttons(kButtons);
    EXPECT_FALSE(buttons.inputFor(1, false, 1s));
    EXPECT_TRUE(buttons.inputFor(1, true, 2s));
}

}  // namespace
}  // namespace fantascope::show
