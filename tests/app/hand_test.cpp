#include "app/hand.h"

#include "app/running_show.h"

#include <gmock/gmock.h>

namespace fantascope::app {
namespace {

using namespace std::chrono_literals;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

class HandPart : public testing::Test {
protected:
    HandPart() {
        hand_.feed(lamps_);
        hand_.tell = [this](const std::string& sentence) { told_.push_back(sentence); };
    }
    void press(show::Button button) {
        for (const bool down : {true, false}) run_.world.press(run_.buttonOf(button), down);
        hand_.tick(run_.clock.now());
    }
    show::ShowState stateOfLamps() {
        show::ShowState state;
        lamps_.stateAt(run_.clock.now(), state);
        return state;
    }

    RunningShow run_;
    PlaybackReplica lamps_{run_.cues};
    Hand hand_{run_.show, run_.cues, run_.site, run_.devices.cueController.get(), Time{}};
    std::vector<std::string> told_;
};

TEST_F(HandPart, a_press_reaches_every_part_of_the_show_and_the_operator) {
    run_.clock.advance(2s);
    press(show::Button::Go);
    EXPECT_EQ(stateOfLamps().cue, 0);
    EXPECT_THAT(told_, ElementsAre("cue 1 of 6: Dusk"));
    run_.clock.advance(2s);
    press(show::Button::Blackout);
    EXPECT_TRUE(stateOfLamps().blackout);
    ASSERT_EQ(hand_.cues().size(), 1u);
    EXPECT_EQ(hand_.cues()[0].name, "Dusk");
    EXPECT_EQ(hand_.cues()[0].entered, 2s);
}

// Otherwise the operator presses again, harder.
TEST_F(HandPart, says_why_a_press_did_nothing) {
    run_.clock.advance(2s);
    press(show::Button::Back);
    EXPECT_THAT(told_, Contains(HasSubstr("ignored")));
    EXPECT_EQ(stateOfLamps().cue, -1);
}

TEST_F(HandPart, a_controller_that_is_pulled_out_and_put_back_presses_nothing) {
    run_.clock.advance(2s);
    run_.world.press(run_.buttonOf(show::Button::Go), true);
    run_.world.setPlugged("cue controller", false);
    hand_.tick(run_.clock.now());
    run_.clock.advance(2s);
    run_.world.setPlugged("cue controller", true);
    hand_.tick(run_.clock.now());
    EXPECT_EQ(stateOfLamps().cue, -1);
    press(show::Button::Go);
    EXPECT_EQ(stateOfLamps().cue, 0);
}

std::vector<Time> pressesOf(GoSchedule schedule) {
    std::vector<Time> presses;
    for (Time time{}; time < 70s; time += 10ms)
        while (schedule.due(time)) presses.push_back(time);
    return presses;
}

TEST(GoSchedule, reaches_every_cue_in_an_equal_share_of_the_length) {
    EXPECT_THAT(pressesOf({3, false, 60s}), ElementsAre(3340ms, 23340ms, 43340ms)) << "after a moment of darkness";
    EXPECT_THAT(pressesOf({2, true, 60s}), ElementsAre(20s, 40s)) << "the cue that is on has its share first";
    EXPECT_THAT(pressesOf({0, true, 60s}), ElementsAre());
}

TEST(GoSchedule, ends_when_the_operator_takes_over) {
    GoSchedule schedule(3, false, 60s);
    EXPECT_TRUE(schedule.due(10s));
    schedule.end();
    EXPECT_FALSE(schedule.due(50s));
    EXPECT_TRUE(schedule.ended());
}

}  // namespace
}  // namespace fantascope::app
