// What an operator holds of a show: time, light, or what is seen.

#include "show/play/played.h"

#include <gmock/gmock.h>
#include <malloc.h>

namespace fantascope::show {
namespace {

using namespace std::chrono_literals;
using testing::Each;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

using Kind = Input::Kind;

// One output, two channels and a street lamp, whose safe state is on.
//   cue 0, fade 2 s: source 0, channels 1 and 0, lamp off; 10 s later:
//   cue 1, fade 4 s: source 1, channels 0 and 0.5, lamp off
//   cue 2, cut:      dark, lamp on
CueList cues() {
    CueList list;
    list.cues = {{{{{{{0, 1.0f}}}}, {1.0f, 0.0f}, {0}}, 2s, 10s},
                 {{{{{{1, 1.0f}}}}, {0.0f, 0.5f}, {0}}, 4s, std::nullopt},
                 {{{{}}, {0.0f, 0.0f}, {1}}, 0s, std::nullopt}};
    list.dark = {{{}}, {0.0f, 0.0f}, {1}};
    list.goInterval = 300ms;
    list.blackoutFade = 500ms;
    list.panicFade = 2s;
    return list;
}

Playback after(std::initializer_list<Input> inputs) { return show::after(cues(), inputs); }

TEST(HeldPlayback, a_pause_keeps_the_middle_of_a_fade_and_goes_on_from_there) {
    Playback playback = after({{0s, Kind::Go}, {1s, Kind::Pause}});
    for (const Time time : {1s, 5s, 3600s}) {
        const ShowState state = stateOf(playback, time);
        EXPECT_THAT(state.levels, ElementsAre(0.5f, 0)) << seconds(time);
        EXPECT_EQ(state.cueTime, 1s);
        EXPECT_TRUE(state.paused);
        EXPECT_FALSE(state.moves);
        EXPECT_EQ(state.time, time);
        EXPECT_EQ(playback.fadeLeftAt(time), 1s);
        EXPECT_EQ(playback.untilFollowAt(time), 9s) << "a follow waits, too";
    }
    EXPECT_EQ(playback.apply({5s, Kind::Pause}), Outcome::Taken);
    EXPECT_NEAR(stateOf(playback, 5500ms).levels[0], 0.75f, 1e-6);
    EXPECT_FALSE(stateOf(playback, 5500ms).paused);
    EXPECT_EQ(stateOf(playback, 13900ms).cue, 0);
    EXPECT_EQ(stateOf(playback, 14s).cue, 1) << "four seconds later than without the pause";
    EXPECT_THAT(stateOf(playback, 4s).levels, ElementsAre(0.5f, 0)) << "the past does not change";
}

TEST(HeldPlayback, go_ends_a_pause_and_enters_no_cue) {
    Playback playback = after({{0s, Kind::Go}, {4s, Kind::Pause}, {9s, Kind::Go}});
    EXPECT_EQ(stateOf(playback, 9s).cue, 0);
    EXPECT_FALSE(stateOf(playback, 9s).paused);
    EXPECT_EQ(playback.apply({9200ms, Kind::Go}), Outcome::TooSoonAfterCue) << "a press that bounces";
    EXPECT_EQ(playback.apply({9300ms, Kind::Go}), Outcome::Taken);
    EXPECT_EQ(stateOf(playback, 9300ms).cue, 1);
}

// Example failure: a cue that is entered in a pause switches its relays in the past, too.
TEST(HeldPlayback, what_ends_a_pause_does_not_change_what_was_seen_in_it) {
    for (const Input& input : {Input{12s, Kind::Jump, 2}, Input{12s, Kind::Back}}) {
        Playback playback = after({{0s, Kind::Jump, 1}, {10s, Kind::Pause}});
        const ShowState before = stateOf(playback, 11s);
        EXPECT_EQ(playback.apply(input), Outcome::Taken);
        EXPECT_EQ(stateOf(playback, 11s), before);
        EXPECT_NE(stateOf(playback, 12s).cue, 1);
        EXPECT_FALSE(stateOf(playback, 12s).paused);
    }
}

TEST(HeldPlayback, a_revision_in_a_pause_stands_still_too_and_leaves_the_past) {
    CueList other = cues();
    other.cues[0].look.levels = {0.2f, 0.2f};
    other.cues[0].look.relays = {1};
    Playback playback = after({{0s, Kind::Go}, {4s, Kind::Pause}});
    const ShowState before = stateOf(playback, 5s);
    EXPECT_EQ(playback.apply({6s, Kind::Revise}, std::make_shared<const CueList>(other)), Outcome::Taken);
    EXPECT_EQ(stateOf(playback, 5s), before);
    EXPECT_THAT(stateOf(playback, 100s).levels, ElementsAre(1, 0));
    EXPECT_EQ(playback.apply({100s, Kind::Go}), Outcome::Taken);
    EXPECT_THAT(stateOf(playback, 101s).levels, ElementsAre(0.2f, 0.2f));
}

TEST(HeldPlayback, a_freeze_keeps_what_is_seen_while_the_cues_go_on) {
    Playback playback = after({{0s, Kind::Go}, {1s, Kind::Freeze}});
    for (const Time time : {1s, 9s, 12s}) {
        const ShowState state = stateOf(playback, time);
        EXPECT_THAT(state.levels, ElementsAre(0.5f, 0)) << seconds(time);
        EXPECT_EQ(state.outputs[0].layers[0].opacity, 0.5f);
        EXPECT_EQ(state.cueTime, 1s) << "videos and patterns stand still";
        EXPECT_TRUE(state.frozen);
        EXPECT_EQ(state.cue, time < 10s ? 0 : 1) << "it followed unseen";
    }
    EXPECT_EQ(playback.apply({20s, Kind::Go}), Outcome::Taken);
    EXPECT_THAT(stateOf(playback, 21s).relays, ElementsAre(0));
    EXPECT_EQ(playback.apply({22s, Kind::Freeze}), Outcome::Taken);
    EXPECT_THAT(stateOf(playback, 22s).relays, ElementsAre(1));
    EXPECT_THAT(stateOf(playback, 22s).levels, Each(0));
    EXPECT_EQ(stateOf(playback, 22s).cueTime, 22s);
    EXPECT_THAT(stateOf(playback, 12s).levels, ElementsAre(0.5f, 0)) << "the past does not change";
}

TEST(HeldPlayback, a_frozen_show_goes_dark_in_a_blackout) {
    const Playback playback = after({{0s, Kind::Go}, {3s, Kind::Freeze}, {4s, Kind::Dark}});
    EXPECT_THAT(stateOf(playback, 5s).levels, Each(0));
    EXPECT_THAT(stateOf(playback, 5s).outputs[0].layers, IsEmpty());
}

TEST(HeldPlayback, a_panic_makes_all_dark_and_safe_and_restore_goes_on_from_there) {
    Playback playback = after({{0s, Kind::Go}, {6s, Kind::Panic}});
    EXPECT_THAT(stateOf(playback, 6s).relays, ElementsAre(1)) << "at once";
    EXPECT_THAT(stateOf(playback, 7s).levels, ElementsAre(0.5f, 0));
    EXPECT_THAT(stateOf(playback, 8s).levels, Each(0));
    EXPECT_THAT(stateOf(playback, 3600s).outputs[0].layers, IsEmpty());
    EXPECT_EQ(stateOf(playback, 3600s).cue, 0) << "nothing follows";
    for (const Kind kind : {Kind::Go, Kind::Back, Kind::Jump, Kind::Pause, Kind::Freeze})
        EXPECT_EQ(playback.apply({3600s, kind}), Outcome::Panicked);
    EXPECT_EQ(playback.apply({3600s, Kind::Restore}), Outcome::Taken);
    EXPECT_EQ(playback.apply({3600s, Kind::Restore}), Outcome::NothingToRestore);
    EXPECT_EQ(playback.apply({3600100ms, Kind::Go}), Outcome::TooSoonAfterCue);
    EXPECT_THAT(stateOf(playback, 3600s).relays, ElementsAre(0));
    EXPECT_THAT(stateOf(playback, 3601s).levels, ElementsAre(1, 0));
    EXPECT_EQ(stateOf(playback, 3603900ms).cue, 0);
    EXPECT_EQ(stateOf(playback, 3604s).cue, 1) << "ten seconds of cue time after it was entered";
}

TEST(HeldPlayback, a_second_panic_is_dark_at_once) {
    const Playback playback = after({{0s, Kind::Go}, {6s, Kind::Panic}, {6500ms, Kind::Panic}});
    EXPECT_NEAR(stateOf(playback, 6500ms - 1ns).levels[0], 0.75f, 1e-6);
    EXPECT_THAT(stateOf(playback, 6500ms).levels, Each(0));
}

TEST(HeldPlayback, restore_keeps_a_pause_and_a_blackout_that_were_before_the_panic) {
    const Playback playback =
        after({{0s, Kind::Go}, {4s, Kind::Pause}, {5s, Kind::Dark}, {6s, Kind::Panic}, {9s, Kind::Restore}});
    const ShowState state = stateOf(playback, 60s);
    EXPECT_TRUE(state.paused);
    EXPECT_TRUE(state.blackout);
    EXPECT_EQ(state.cueTime, 4s);
    EXPECT_THAT(state.levels, Each(0));
}

TEST(HeldPlayback, a_loaded_cue_is_what_go_enters) {
    Playback playback = after({{0s, Kind::Go}, {1s, Kind::Load, 2}});
    EXPECT_EQ(stateOf(playback, 0s).next, 1);
    EXPECT_EQ(stateOf(playback, 1s).next, 2);
    EXPECT_EQ(stateOf(playback, 1s).loaded, 2);
    EXPECT_EQ(stateOf(playback, 11s).cue, 1) << "a follow enters what it always enters";
    EXPECT_EQ(stateOf(playback, 11s).next, 2);
    EXPECT_EQ(playback.apply({12s, Kind::Go}), Outcome::Taken);
    EXPECT_EQ(stateOf(playback, 12s).cue, 2);
    EXPECT_EQ(stateOf(playback, 12s).next, std::nullopt);
    EXPECT_EQ(playback.apply({13s, Kind::Load, 0}), Outcome::Taken) << "a loaded cue comes even after the last";
    EXPECT_EQ(playback.apply({14s, Kind::Go}), Outcome::Taken);
    EXPECT_EQ(stateOf(playback, 14s).cue, 0);
    EXPECT_EQ(playback.apply({15s, Kind::Load, 3}), Outcome::NoSuchCue);
    EXPECT_EQ(playback.apply({15s, Kind::Load, 2}), Outcome::Taken);
    EXPECT_EQ(playback.apply({15s, Kind::Load, -1}), Outcome::Taken);
    EXPECT_EQ(stateOf(playback, 15s).next, 1);
}

TEST(HeldPlayback, a_loaded_cue_is_found_again_by_name_after_a_revision) {
    CueList list = cues();
    for (std::size_t i = 0; i < 3; ++i) list.cues[i].name = std::string(1, static_cast<char>('A' + i));
    Playback playback(list);
    EXPECT_EQ(playback.apply({0s, Kind::Load, 2}), Outcome::Taken);
    std::swap(list.cues[0], list.cues[2]);
    EXPECT_EQ(playback.apply({1s, Kind::Revise}, std::make_shared<const CueList>(list)), Outcome::Taken);
    EXPECT_EQ(stateOf(playback, 1s).next, 0);
    list.cues.erase(list.cues.begin());
    EXPECT_EQ(playback.apply({2s, Kind::Revise}, std::make_shared<const CueList>(list)), Outcome::Taken);
    EXPECT_EQ(stateOf(playback, 2s).loaded, -1);
}

TEST(HeldPlayback, the_master_dims_pictures_and_levels_beside_a_blackout) {
    Input half{4s, Kind::Master};
    half.level = 0.5f;
    Playback playback = after({{0s, Kind::Go}, half});
    EXPECT_THAT(stateOf(playback, 5s).levels, ElementsAre(0.5f, 0));
    EXPECT_EQ(stateOf(playback, 5s).outputs[0].layers[0].opacity, 0.5f);
    EXPECT_EQ(stateOf(playback, 5s).master, 0.5f);
    EXPECT_THAT(stateOf(playback, 5s).relays, ElementsAre(0));
    EXPECT_EQ(playback.apply({5s, Kind::Dark}), Outcome::Taken);
    EXPECT_THAT(stateOf(playback, 6s).levels, Each(0));
    EXPECT_EQ(playback.apply({6s, Kind::Light}), Outcome::Taken);
    EXPECT_THAT(stateOf(playback, 7s).levels, ElementsAre(0.5f, 0));
    for (const float level : {-0.1f, 1.1f, std::numeric_limits<float>::quiet_NaN()}) {
        half.level = level;
        EXPECT_EQ(playback.apply(half), Outcome::NoSuchLevel);
    }
}

TEST(HeldPlayback, a_lock_still_lets_everybody_make_it_dark) {
    Playback playback = after({{0s, Kind::Go}, {1s, Kind::Lock}});
    const auto byHand = [&](Kind kind) { return playback.apply({.at = 2s, .kind = kind, .source = Input::Source::Controller}); };
    for (const Kind kind : {Kind::Go, Kind::Load, Kind::Pause, Kind::Freeze, Kind::Master})
        EXPECT_EQ(byHand(kind), Outcome::Locked);
    for (const Kind kind : {Kind::Blackout, Kind::Panic, Kind::Restore}) EXPECT_EQ(byHand(kind), Outcome::Taken);
}

// Example failure: somebody presses GO three times at a machine that does not answer, and three
// cues pass in one moment.
TEST(HeldPlayback, what_comes_too_late_is_ignored_but_for_darkness) {
    Playback playback = after({{0s, Kind::Go}});
    const auto late = [&](Kind kind, int cue = 0) { return playback.apply({.at = 2s, .kind = kind, .cue = cue, .late = true}); };
    for (const Kind kind : {Kind::Go, Kind::Back, Kind::Jump, Kind::Load, Kind::Pause, Kind::Freeze, Kind::Restore, Kind::Master,
                            Kind::Lock, Kind::Corrections})
        EXPECT_EQ(late(kind), Outcome::TooLate);
    EXPECT_EQ(stateOf(playback, 2s).cue, 0);
    EXPECT_EQ(late(Kind::Blackout), Outcome::Taken);
    EXPECT_EQ(late(Kind::Blackout), Outcome::Taken);
    EXPECT_TRUE(stateOf(playback, 2s).blackout) << "two presses of somebody who wants it dark";
    EXPECT_EQ(late(Kind::Panic), Outcome::Taken);
    EXPECT_TRUE(stateOf(playback, 2s).panic);
}

// Example failure: after thirty nights of a hand on the blackout, every question takes longer.
TEST(HeldPlayback, of_a_million_inputs_it_keeps_ten_minutes) {
    CueList list = cues();
    list.loops = true;
    Playback playback(list);
    constexpr Kind kKinds[] = {Kind::Go,    Kind::Blackout,    Kind::Pause,      Kind::Pause, Kind::Freeze,
                               Kind::Panic, Kind::Restore,     Kind::Light,      Kind::Lock,  Kind::Load,
                               Kind::Back,  Kind::Corrections, Kind::Corrections};
    std::size_t kept = 0;
    for (int i = 0; i < 1'000'000; ++i) {
        playback.apply({i * 1s, kKinds[static_cast<std::size_t>(i) % std::size(kKinds)], i % 3});
        if (i == 10'000) kept = ::mallinfo2().uordblks;
    }
    EXPECT_LT(::mallinfo2().uordblks, kept + 100'000);
}

// For the technician on the ladder, while the show runs.
TEST(HeldPlayback, a_highlight_shows_a_lamp_and_a_solo_nothing_else) {
    CueList list = cues();
    list.fixtures = {{0, 1}, {1, 1}};
    const auto highlight = [](Time at, int fixture) { return Input{.at = at, .kind = Kind::Highlight, .fixture = fixture}; };
    Playback playback =
        show::after(list, {{0s, Kind::Go}, highlight(3s, 1), {5s, Kind::Solo}, {7s, Kind::Dark}, {8s, Kind::Solo}});
    EXPECT_THAT(stateOf(playback, 4s).levels, ElementsAre(1, 1));
    EXPECT_EQ(stateOf(playback, 4s).highlight, 1);
    EXPECT_THAT(stateOf(playback, 6s).levels, ElementsAre(0, 1));
    EXPECT_THAT(stateOf(playback, 6s).outputs[0].layers, IsEmpty());
    EXPECT_THAT(stateOf(playback, 6s).relays, ElementsAre(0)) << "lamps of the street stay as the cue has them";
    EXPECT_THAT(stateOf(playback, 9s).levels, ElementsAre(0, 1)) << "in a blackout, too";
    EXPECT_THAT(stateOf(playback, 2s).levels, ElementsAre(1, 0)) << "the past does not change";
    ASSERT_EQ(playback.apply(highlight(9s, -1)), Outcome::Taken);
    EXPECT_THAT(stateOf(playback, 9s).levels, ElementsAre(0, 0));
    EXPECT_EQ(playback.apply({9s, Kind::Solo}), Outcome::NoSuchFixture) << "nobody would know of which lamp";
    EXPECT_EQ(playback.apply(highlight(9s, 2)), Outcome::NoSuchFixture);
}

TEST(HeldPlayback, a_panic_and_the_end_of_the_night_end_a_highlight) {
    CueList list = cues();
    list.fixtures = {{0, 1}, {1, 1}};
    const Input highlight{.at = 3s, .kind = Kind::Highlight, .fixture = 1};
    Playback panic = show::after(list, {{0s, Kind::Go}, highlight, {3s, Kind::Solo}, {4s, Kind::Panic}});
    EXPECT_THAT(stateOf(panic, 10s).levels, ElementsAre(0, 0));
    EXPECT_EQ(panic.apply({.at = 11s, .kind = Kind::Highlight, .fixture = 0}), Outcome::Panicked);
    panic.apply({12s, Kind::Restore});
    EXPECT_THAT(stateOf(panic, 13s).levels, ElementsAre(1, 0));
    Playback end = show::after(list, {{0s, Kind::Go}, highlight, {.at = 4s, .kind = Kind::Jump, .cue = -1}});
    EXPECT_THAT(stateOf(end, 10s).levels, ElementsAre(0, 0));
    EXPECT_EQ(stateOf(end, 10s).highlight, -1);
}

// For a work light, or a lamp that is broken.
TEST(HeldPlayback, a_parked_lamp_stays_as_it_was_seen) {
    CueList list = cues();
    list.fixtures = {{0, 1}, {1, 1}};
    const auto park = [](Time at, int fixture) { return Input{.at = at, .kind = Kind::Park, .fixture = fixture}; };
    Playback playback = show::after(list, {{0s, Kind::Go},
                                           {.at = 3s, .kind = Kind::Highlight, .fixture = 1},
                                           {.at = 3s, .kind = Kind::Level, .level = 0.25f},
                                           park(4s, 1),
                                           {.at = 5s, .kind = Kind::Highlight},
                                           {7s, Kind::Dark}});
    EXPECT_THAT(stateOf(playback, 3500ms).levels, ElementsAre(1, 0.25f));
    EXPECT_THAT(stateOf(playback, 3500ms).parked, IsEmpty());
    EXPECT_THAT(stateOf(playback, 6s).levels, ElementsAre(1, 0.25f));
    EXPECT_THAT(stateOf(playback, 6s).parked, ElementsAre(1));
    EXPECT_THAT(stateOf(playback, 9s).levels, ElementsAre(0, 0.25f)) << "through a blackout";
    ASSERT_EQ(playback.apply(park(9s, 0)), Outcome::Taken);
    ASSERT_EQ(playback.apply({10s, Kind::Light}), Outcome::Taken);
    EXPECT_THAT(stateOf(playback, 12s).levels, ElementsAre(0, 0.25f));
    ASSERT_EQ(playback.apply({.at = 12s, .kind = Kind::Highlight, .fixture = 0}), Outcome::Taken);
    EXPECT_THAT(stateOf(playback, 12s).levels, ElementsAre(1, 0.25f)) << "a highlight shows it all the same";
    ASSERT_EQ(playback.apply({.at = 13s, .kind = Kind::Highlight}), Outcome::Taken);
    ASSERT_EQ(playback.apply(park(14s, 1)), Outcome::Taken);
    EXPECT_THAT(stateOf(playback, 14s).parked, ElementsAre(0));
    EXPECT_EQ(playback.apply(park(14s, 2)), Outcome::NoSuchFixture);
    EXPECT_EQ(playback.apply(park(14s, -1)), Outcome::NoSuchFixture);
}

// The highest of cues and hand counts, and nobody is dazzled when a cue is brighter.
TEST(HeldPlayback, a_raised_lamp_shines_at_least_so_bright) {
    CueList list = cues();
    list.fixtures = {{0, 1}, {1, 1}};
    const auto raise = [](Time at, float level, int fixture) {
        return Input{.at = at, .kind = Kind::Raise, .level = level, .fixture = fixture};
    };
    Playback playback = show::after(list, {raise(1s, 0.5f, 0), raise(1s, 0.25f, 1), {2s, Kind::Go}, {6s, Kind::Dark}});
    EXPECT_THAT(stateOf(playback, 1500ms).levels, ElementsAre(0.5f, 0.25f)) << "before the first cue, too";
    EXPECT_THAT(stateOf(playback, 5s).levels, ElementsAre(1, 0.25f));
    EXPECT_THAT(stateOf(playback, 5s).raised, ElementsAre(RaisedLamp{0, 0.5f}, RaisedLamp{1, 0.25f}));
    EXPECT_THAT(stateOf(playback, 9s).levels, ElementsAre(0, 0)) << "a blackout makes it dark";
    EXPECT_EQ(playback.apply(raise(9s, 1.5f, 0)), Outcome::NoSuchLevel);
    EXPECT_EQ(playback.apply(raise(9s, 1, 2)), Outcome::NoSuchFixture);
    ASSERT_EQ(playback.apply(raise(9s, 0, 1)), Outcome::Taken);
    EXPECT_THAT(stateOf(playback, 9s).raised, ElementsAre(RaisedLamp{0, 0.5f}));
    ASSERT_EQ(playback.apply({10s, Kind::Panic}), Outcome::Taken);
    EXPECT_EQ(playback.apply(raise(11s, 1, 0)), Outcome::Panicked);
    ASSERT_EQ(playback.apply({12s, Kind::Restore}), Outcome::Taken);
    EXPECT_THAT(stateOf(playback, 12s).raised, SizeIs(1)) << "everything goes on from where it was";
    ASSERT_EQ(playback.apply({.at = 13s, .kind = Kind::Jump, .cue = -1}), Outcome::Taken);
    EXPECT_THAT(stateOf(playback, 13s).raised, IsEmpty()) << "at the end of the night nothing keeps the light on";
}

// Example failures: a cue that does not name the relay switches it back; one that does is ignored
// for the rest of the night.
TEST(HeldPlayback, a_relay_stays_as_the_hand_has_it_until_a_cue_switches_it) {
    CueList list = cues();
    list.dark.relays = {0, 1};
    for (CueList::Cue& cue : list.cues) cue.look.relays = {0, 1};
    list.cues[1].tracksRelays = {1, 1};
    const auto switched = [](Time at, int relay, bool on) {
        return Input{.at = at, .kind = Kind::Switch, .relay = relay, .on = on};
    };
    Playback playback = show::after(list, {{1s, Kind::Go}, switched(2s, 0, true)});
    EXPECT_THAT(stateOf(playback, 1999ms).relays, ElementsAre(0, 1));
    EXPECT_THAT(stateOf(playback, 2s).relays, ElementsAre(1, 1));
    EXPECT_THAT(stateOf(playback, 2s).switched, ElementsAre(SwitchedRelay{0, true}));
    ASSERT_EQ(playback.apply({.at = 3s, .kind = Kind::Jump, .cue = 1}), Outcome::Taken);
    EXPECT_THAT(stateOf(playback, 5s).relays, ElementsAre(1, 1)) << "this cue does not name them";
    ASSERT_EQ(playback.apply({6s, Kind::Panic}), Outcome::Taken);
    EXPECT_THAT(stateOf(playback, 7s).relays, ElementsAre(0, 1)) << "safe";
    ASSERT_EQ(playback.apply({8s, Kind::Restore}), Outcome::Taken);
    EXPECT_THAT(stateOf(playback, 8s).relays, ElementsAre(1, 1));
    ASSERT_EQ(playback.apply({.at = 9s, .kind = Kind::Jump, .cue = 0}), Outcome::Taken);
    EXPECT_THAT(stateOf(playback, 9s).relays, ElementsAre(0, 1));
    EXPECT_THAT(stateOf(playback, 9s).switched, IsEmpty()) << "a cue has switched it";
    ASSERT_EQ(playback.apply(switched(10s, 1, false)), Outcome::Taken);
    EXPECT_THAT(stateOf(playback, 10s).relays, ElementsAre(0, 0));
    ASSERT_EQ(playback.apply({11s, Kind::Release}), Outcome::Taken);
    EXPECT_THAT(stateOf(playback, 11s).relays, ElementsAre(0, 1));
    EXPECT_EQ(playback.apply(switched(12s, 2, true)), Outcome::NoSuchRelay);
}

// Example failures: a work light burns through a panic, or all night; a broken lamp comes back.
TEST(HeldPlayback, a_panic_and_the_end_of_the_night_let_lit_lamps_go) {
    CueList list = cues();
    list.fixtures = {{0, 1}, {1, 1}};
    const Input lit{.at = 3s, .kind = Kind::Park, .fixture = 0}, dark{.at = 3s, .kind = Kind::Park, .fixture = 1};
    for (const Input& end : {Input{.at = 4s, .kind = Kind::Panic}, Input{.at = 4s, .kind = Kind::Jump, .cue = -1}}) {
        const Playback playback = show::after(list, {{0s, Kind::Go}, lit, dark, end});
        EXPECT_THAT(stateOf(playback, 10s).levels, ElementsAre(0, 0));
        EXPECT_THAT(stateOf(playback, 10s).parked, ElementsAre(1));
    }
}

}  // namespace
}  // namespace fantascope::show
