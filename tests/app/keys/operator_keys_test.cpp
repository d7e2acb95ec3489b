// The keys at the windows, without a terminal: what they ask for, and when.

#include "app/keys/operator_keys.h"

#include "app/running_show.h"

#include "show/names.h"

#include <gmock/gmock.h>

#include <memory>
#include <vector>

namespace fantascope::app {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;
using Kind = show::Input::Kind;
using Source = show::Input::Source;

class Keys : public testing::Test {
protected:
    std::unique_ptr<OperatorKeys> keysWith(GoSchedule schedule, bool quitAsks = false, bool hasController = false) {
        return std::make_unique<OperatorKeys>(
            run_.inputs, run_.events, show::ShowClock(10s, 3h), nullptr, schedule, QuitKey(quitAsks),
            OperatorKeys::Actions{[this](const Key&) { return settingUp_; }, [hasController] { return hasController; },
                                  [this] { ++pictures_; }, [this] { ++ends_; }, [] { return "20:00  Night"; },
                                  [](const show::ShowState& state) { return state.cue < 0 ? "dark" : "lit"; },
                                  show::namesOf(run_.site.relays)});
    }
    std::vector<show::Input> inputs() const {
        std::vector<show::Input> inputs;
        show::InputLog::Reader reader = run_.inputs.reader();
        while (const show::LoggedInput* const logged = reader.next()) inputs.push_back(logged->input);
        return inputs;
    }
    // The input that a key at a window gives, a tenth of a second after the one before.
    show::Input inputAfter(char letter, OperatorKeys& keys) {
        keys.pressedAtScreen({.letter = letter}, moment_ += 100ms);
        keys.tick(moment_);
        return inputs().back();
    }

    RunningShow run_;
    Time moment_ = 12s;
    bool settingUp_ = false;
    int pictures_ = 0, ends_ = 0;
};

// Example failure: a press at a window counts from when the program came to look, up to a thirtieth
// of a second later.
TEST_F(Keys, at_a_window_ask_for_what_the_hand_controller_does_at_the_moment_of_the_press) {
    const auto keys = keysWith({0, false, {}});
    keys->pressedAtScreen({.letter = ' '}, 12s);
    keys->pressedAtScreen({.letter = 'b'}, 12s + 1ms);
    keys->pressedAtScreen({.letter = '0'}, 12s + 2ms);
    keys->pressedAtScreen({.letter = 's'}, 12s + 3ms);
    keys->pressedAtScreen({.letter = 'y'}, 12s + 3ms);
    EXPECT_THAT(inputs(), IsEmpty());
    keys->tick(12s + 33ms);
    EXPECT_THAT(inputs(), ElementsAre(show::Input{.at = 3h + 2s, .kind = Kind::Go, .source = Source::Screen},
                                      show::Input{.at = 3h + 2s + 1ms, .kind = Kind::Back, .source = Source::Screen},
                                      show::Input{.at = 3h + 2s + 2ms, .kind = Kind::Blackout, .source = Source::Screen}));
    EXPECT_EQ(pictures_, 1);
    EXPECT_EQ(ends_, 0);
}

TEST_F(Keys, hold_time_and_light) {
    const auto keys = keysWith({0, false, {}});
    for (const char letter : {'p', 'f', 'r', 'l', 'c'}) keys->pressedAtScreen({.letter = letter}, 12s);
    keys->pressedAtScreen({Key::Name::Escape}, 12s);
    keys->tick(12s);
    std::vector<Kind> kinds;
    for (const show::Input& input : inputs()) kinds.push_back(input.kind);
    EXPECT_THAT(kinds, ElementsAre(Kind::Pause, Kind::Freeze, Kind::Restore, Kind::Lock, Kind::Corrections, Kind::Panic));
}

// The show has six cues.
TEST_F(Keys, load_the_cue_beside_the_one_that_go_would_enter) {
    const auto keys = keysWith({0, false, {}});
    const auto loadedBy = [&](Key::Name key) {
        keys->pressedAtScreen({key}, 12s);
        keys->tick(12s);
        EXPECT_EQ(inputs().back().kind, Kind::Load);
        return inputs().back().cue;
    };
    EXPECT_EQ(loadedBy(Key::Name::Down), 1);
    EXPECT_EQ(loadedBy(Key::Name::Down), 2);
    EXPECT_EQ(loadedBy(Key::Name::Up), 1);
    EXPECT_EQ(loadedBy(Key::Name::Up), 0);
    EXPECT_EQ(loadedBy(Key::Name::Up), 0) << "it is the first";
    run_.inputs.submit({.at = 3h + 2s, .kind = Kind::Jump, .cue = 5});
    EXPECT_EQ(loadedBy(Key::Name::Down), 5) << "no cue comes after the last";
    EXPECT_EQ(loadedBy(Key::Name::Up), 4);
}

// Example failure: rounding makes the tenth press reach 0.99999994.
// GO, back and load for the list that Tab has chosen; all else is for the whole show.
TEST_F(Keys, go_to_the_list_that_was_chosen) {
    show::CueList side = run_.cues;
    side.name = "Bar";
    run_.cues.sides.push_back(std::make_shared<const show::CueList>(side));
    show::InputLog inputs(run_.cues);
    OperatorKeys keys(inputs, run_.events, show::ShowClock(10s, 3h), nullptr, {0, false, {}}, QuitKey(false),
                      OperatorKeys::Actions{[](const Key&) { return false; },
                                            [] { return false; },
                                            [] {},
                                            [] {},
                                            [] { return ""; },
                                            [](const show::ShowState&) { return ""; },
                                            {}});
    const Key tab{.name = Key::Name::Tab};
    Time moment = 12s;
    const auto press = [&](const Key& key) {
        keys.pressedAtScreen(key, moment += 100ms);
        keys.tick(moment);
    };
    for (const Key& key :
         {tab, Key{.letter = ' '}, Key{.name = Key::Name::Down}, Key{.letter = 'b'}, Key{.letter = '0'}, tab, Key{.letter = ' '}})
        press(key);
    std::vector<std::pair<Kind, int>> asked;
    auto reader = inputs.reader();
    while (const show::LoggedInput* const logged = reader.next()) asked.emplace_back(logged->input.kind, logged->input.list);
    EXPECT_THAT(asked, ElementsAre(std::pair(Kind::Go, 1), std::pair(Kind::Load, 1), std::pair(Kind::Back, 1),
                                   std::pair(Kind::Blackout, 0), std::pair(Kind::Go, 0)));
    EXPECT_EQ(keys.list(), 0);
    EXPECT_EQ(run_.told().front(), "GO, back and load are now for 'Bar'");
    EXPECT_EQ(run_.told().back(), "GO, back and load are now for the show's own cues");
}

// Example failure: a rehearsal presses GO while somebody steps it at the page.
TEST_F(Keys, end_the_schedule_when_somebody_presses_at_the_page) {
    const auto keys = keysWith({3, false, 60s});
    keys->tick(12s);
    ASSERT_NE(keys->nextGo(), Time::max());
    run_.inputs.submit({.at = 12s, .kind = Kind::Blackout, .source = Source::Page});
    keys->tick(12s + 10ms);
    EXPECT_EQ(keys->nextGo(), Time::max());
    EXPECT_EQ(run_.told().back(), "you have the controller");
}

TEST_F(Keys, highlight_one_lamp_after_the_other) {
    const auto keys = keysWith({0, false, {}});
    const auto pressed = [&](char letter) { return inputAfter(letter, *keys); };
    const int count = static_cast<int>(run_.site.fixtures.size());
    ASSERT_GT(count, 0);
    for (int fixture = 0; fixture < count; ++fixture) EXPECT_EQ(pressed('h').fixture, fixture);
    EXPECT_EQ(pressed('o').kind, Kind::Solo);
    EXPECT_EQ(pressed('h').fixture, -1) << "after the last one none";
    EXPECT_EQ(pressed('h').fixture, 0);
}

// Example failure: the level is that of the master, or of the lamp before.
TEST_F(Keys, dim_and_park_the_highlighted_lamp) {
    const auto keys = keysWith({0, false, {}});
    const auto pressed = [&](char letter) { return inputAfter(letter, *keys); };
    pressed('k');
    EXPECT_EQ(inputs().back().fixture, -1) << "no lamp is highlighted";
    pressed('h');
    pressed('-');
    EXPECT_EQ(pressed(',').kind, Kind::Level);
    EXPECT_FLOAT_EQ(pressed(',').level, 0.8f);
    EXPECT_FLOAT_EQ(pressed('.').level, 0.9f);
    EXPECT_EQ(pressed('k').kind, Kind::Park);
    EXPECT_EQ(inputs().back().fixture, 0);
}

// Example failure: x switches a relay that nobody has chosen.
TEST_F(Keys, raise_the_highlighted_lamp_and_switch_the_chosen_relay) {
    const auto keys = keysWith({0, false, {}});
    const auto pressed = [&](char letter) { return inputAfter(letter, *keys); };
    pressed('h');
    pressed(',');
    EXPECT_EQ(pressed('a').kind, Kind::Raise);
    EXPECT_EQ(inputs().back().fixture, 0);
    EXPECT_FLOAT_EQ(inputs().back().level, 0.9f);
    const std::size_t before = inputs().size();
    pressed('x');
    const auto& relays = run_.site.relays;
    ASSERT_EQ(relays.size(), 2u);
    EXPECT_THAT(inputs(), SizeIs(before)) << "none was chosen";
    EXPECT_EQ(run_.told().back(), "x switches relay '" + relays[0].name + "'");
    EXPECT_EQ(pressed('x').kind, Kind::Switch);
    EXPECT_EQ(inputs().back().relay, 0);
    EXPECT_EQ(inputs().back().on, !relays[0].safe);
    EXPECT_EQ(pressed('x').on, relays[0].safe) << "the other way again";
    pressed('w');
    EXPECT_EQ(pressed('x').relay, 1);
    EXPECT_EQ(pressed('z').kind, Kind::Release);
}

TEST_F(Keys, move_the_master_by_a_tenth) {
    const auto keys = keysWith({0, false, {}});
    const auto masterAfter = [&](char letter, int presses) {
        for (int press = 0; press < presses; ++press) keys->pressedAtScreen({.letter = letter}, 12s);
        keys->tick(12s);
        EXPECT_EQ(inputs().back().kind, Kind::Master);
        return inputs().back().level;
    };
    EXPECT_EQ(masterAfter('-', 1), 0.9f);
    EXPECT_EQ(masterAfter('-', 2), 0.7f);
    EXPECT_EQ(masterAfter('+', 1), 0.8f);
    EXPECT_EQ(masterAfter('-', 20), 0);
    EXPECT_EQ(masterAfter('=', 20), 1) << "of the same key as +";
}

// Example failure: the machine stood still for some seconds, and what was typed meanwhile is fired
// in a burst.
TEST_F(Keys, that_come_through_a_machine_that_stood_still_are_late) {
    const auto keys = keysWith({0, false, {}});
    keys->tick(12s);
    keys->pressedAtScreen({.letter = ' '}, 12s + 1ms);
    keys->tick(12s + 5ms);
    EXPECT_FALSE(inputs().back().late);
    for (int press = 0; press < 3; ++press) keys->pressedAtScreen({.letter = ' '}, 13s);
    keys->tick(13s);
    EXPECT_THAT(inputs(), SizeIs(4));
    EXPECT_TRUE(inputs().back().late);
    keys->pressedAtScreen({.letter = ' '}, 13s + 1ms);
    keys->tick(13s + 5ms);
    EXPECT_FALSE(inputs().back().late);
}

TEST_F(Keys, are_told_when_somebody_asks) {
    const auto keys = keysWith({0, false, {}});
    keys->pressedAtScreen({.letter = '/', .shift = true}, 12s);
    keys->tick(12s);
    EXPECT_THAT(inputs(), IsEmpty());
    EXPECT_THAT(run_.told(),
                ElementsAre(testing::StartsWith("the keys:\n  space  GO"), "now: dark", "the schedule, 20:00  Night"));
}

// Example failure: the seventeenth key of somebody in a hurry does nothing.
TEST_F(Keys, are_all_taken_however_many_came_before_anybody_looked) {
    const auto keys = keysWith({0, false, {}});
    for (int press = 0; press < 1000; ++press) keys->pressedAtScreen({.letter = '0'}, 12s);
    keys->tick(13s);
    EXPECT_EQ(inputs().size(), 1000u);
}

TEST_F(Keys, belong_to_the_setting_up_while_that_takes_them) {
    const auto keys = keysWith({0, false, {}});
    settingUp_ = true;
    keys->pressedAtScreen({.letter = 'q'}, 12s);
    keys->pressedAtScreen({.letter = ' '}, 12s);
    keys->tick(12s);
    EXPECT_THAT(inputs(), IsEmpty());
    EXPECT_EQ(ends_, 0);
}

TEST_F(Keys, end_a_night_only_when_they_are_pressed_twice) {
    const auto keys = keysWith({0, false, {}}, true);
    keys->pressedAtScreen({.letter = 'q'}, 12s);
    keys->tick(12s);
    EXPECT_EQ(ends_, 0);
    EXPECT_THAT(run_.told(), ElementsAre("the show goes on; q again within 3 s ends it"));
    keys->pressedAtScreen({.letter = 'q'}, 14s);
    keys->tick(14s);
    EXPECT_EQ(ends_, 1);
}

// The schedule's shares are of the run: a show that is resumed after three hours presses its first
// GO after a moment of darkness, and not all of them at once.
TEST_F(Keys, take_over_from_a_schedule_that_counts_from_the_runs_start) {
    const auto keys = keysWith({3, false, 60s});
    keys->tick(10s);
    EXPECT_THAT(inputs(), IsEmpty());
    EXPECT_EQ(keys->nextGo(), 3'333'333'333ns);
    keys->tick(13335ms);
    EXPECT_THAT(inputs(), IsEmpty()) << "nobody has looked for three seconds: the press would be late";
    keys->tick(13340ms);
    EXPECT_THAT(inputs(), ElementsAre(show::Input{.at = 3h + 3340ms, .kind = Kind::Go, .source = Source::Schedule}));
    keys->pressedAtScreen({.letter = '0'}, 20s);
    keys->pressedAtScreen({.letter = '0'}, 21s);
    keys->tick(21s);
    EXPECT_THAT(run_.told(), ElementsAre("you have the controller"));
    EXPECT_EQ(keys->nextGo(), Time::max());
    keys->tick(60s);
    EXPECT_EQ(inputs().size(), 3u);
}

TEST_F(Keys, leave_the_schedules_press_to_the_controller_where_there_is_one) {
    const auto keys = keysWith({3, false, 60s}, false, true);
    keys->tick(13340ms);
    EXPECT_THAT(inputs(), IsEmpty());
    EXPECT_EQ(keys->nextGo(), 23'333'333'333ns);
}

}  // namespace
}  // namespace fantascope::app
