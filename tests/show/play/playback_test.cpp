#include "show/play/playback.h"

#include "show/play/played.h"

#include "allocations.h"
#include "core/random.h"

#include <gmock/gmock.h>
#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>
#include <utility>

namespace fantascope::show {
namespace {

using namespace std::chrono_literals;
using testing::Each;
using testing::ElementsAre;
using testing::FloatNear;
using testing::IsEmpty;

constexpr Input go(Time at) { return {at, Input::Kind::Go}; }
constexpr Input back(Time at) { return {at, Input::Kind::Back}; }
constexpr Input blackout(Time at) { return {at, Input::Kind::Blackout}; }
constexpr Input jump(Time at, int cue) { return {at, Input::Kind::Jump, cue}; }

// A site of one output, two channels and one street lamp; source 0 and source 1 share the output.
//   cue 0, fade 2 s: source 0 whole, channels 1 and 0, lamp off
//   cue 1, fade 4 s: source 0 half and source 1 whole, channels 0 and 0.5, lamp off
//   cue 2, cut:      dark, lamp on
CueList threeCues() {
    CueList list;
    list.cues = {{{{{{{0, 1.0f}}}}, {1.0f, 0.0f}, {0}}, 2s, std::nullopt},
                 {{{{{{0, 0.5f}, {1, 1.0f}}}}, {0.0f, 0.5f}, {0}}, 4s, std::nullopt},
                 {{{{}}, {0.0f, 0.0f}, {1}}, 0s, std::nullopt}};
    list.dark = {{{}}, {0.0f, 0.0f}, {1}};
    list.goInterval = 300ms;
    list.blackoutFade = list.darkFade = 500ms;
    return list;
}

// Three cues that run by themselves: cue 1 three seconds after cue 0, cue 2 five seconds after
// that.
CueList followingCues() {
    CueList list = threeCues();
    list.cues[0].follow = 3s;
    list.cues[1].follow = 5s;
    return list;
}

// But for when layers began, which has tests of its own.
Look lookOf(const Playback& playback, Time time) {
    Look look = stateOf(playback, time);
    for (OutputState& output : look.outputs)
        for (LayerState& layer : output.layers) layer.begun = Time{};
    return look;
}

std::size_t addedOnes(const OutputState& output) {
    return output.pictures.empty() ? output.layers.size() : output.pictures[0].first;
}

// How much of a source there is in all of an output.
float opacity(const Look& look, std::size_t output, std::uint32_t source) {
    const OutputState& state = look.outputs[output];
    float sum = 0;
    for (std::size_t i = 0; i < addedOnes(state); ++i)
        if (state.layers[i].source.value == source) sum += state.layers[i].opacity;
    for (const ComposedPicture& picture : state.pictures)
        for (std::size_t i = picture.first; i < picture.last; ++i)
            if (state.layers[i].source.value == source) sum += picture.share * state.layers[i].opacity;
    return sum;
}

TEST(Playback, before_the_first_cue_all_is_dark_and_the_relays_are_safe) {
    const ShowState state = stateOf(Playback(threeCues()), 10s);
    EXPECT_EQ(state.cue, -1);
    EXPECT_EQ(static_cast<const Look&>(state), threeCues().dark);
    EXPECT_EQ(state.time, 10s);
    EXPECT_EQ(state.inputs, 0u);
}

TEST(Playback, go_fades_linearly_to_the_next_look_and_stays_there) {
    const Playback playback = after(threeCues(), {go(10s)});
    EXPECT_EQ(stateOf(playback, 10s - 1ns).cue, -1);
    EXPECT_EQ(stateOf(playback, 10s).cue, 0);
    EXPECT_THAT(lookOf(playback, 10s).outputs[0].layers, IsEmpty());
    EXPECT_THAT(lookOf(playback, 10500ms).levels, ElementsAre(0.25f, 0.0f));
    EXPECT_THAT(lookOf(playback, 11s).outputs[0].layers, ElementsAre(LayerState{0, 0.5f}));
    EXPECT_EQ(lookOf(playback, 12s), threeCues().cues[0].look);
    EXPECT_EQ(lookOf(playback, 3600s), threeCues().cues[0].look);
}

TEST(Playback, a_cue_fades_until_its_look_is_whole) {
    const Playback playback = after(followingCues(), {go(10s)});
    for (const Time time : {10s, 11s, 13s, 16s}) EXPECT_TRUE(playback.fadesAt(time)) << seconds(time);
    for (const Time time : {9s, 12s, 17s, 18s, 30s}) EXPECT_FALSE(playback.fadesAt(time)) << seconds(time);
}

TEST(Playback, says_how_long_a_cue_fades_and_when_the_next_one_comes_by_itself) {
    const Playback playback = after(followingCues(), {go(10s)});
    EXPECT_EQ(playback.fadeLeftAt(9s), 0s);
    EXPECT_EQ(playback.fadeLeftAt(10500ms), 1500ms);
    EXPECT_EQ(playback.fadeLeftAt(14s), 3s) << "the second fades in four";
    EXPECT_EQ(playback.fadeLeftAt(17500ms), 0s);
    EXPECT_EQ(playback.untilFollowAt(10500ms), 2500ms);
    EXPECT_EQ(playback.untilFollowAt(13s), 5s);
    EXPECT_EQ(playback.untilFollowAt(18s), std::nullopt) << "nothing follows the third";
    EXPECT_EQ(after(threeCues(), {go(10s)}).untilFollowAt(11s), std::nullopt);
}

// A source on both sides moves from its one opacity to its other. Example failure: it dips, since
// each look is faded as a whole.
TEST(Playback, crossfade_matches_layers_by_their_source) {
    const Playback playback = after(threeCues(), {go(0s), go(10s)});
    EXPECT_THAT(lookOf(playback, 11s).outputs[0].layers, ElementsAre(LayerState{0, 0.875f}, LayerState{1, 0.25f}));
    EXPECT_THAT(lookOf(playback, 12s).levels, ElementsAre(0.5f, 0.25f));
    EXPECT_EQ(lookOf(playback, 14s), threeCues().cues[1].look);
}

// Example failures: what was fading stands still while the cue waits; the lamp switches with the
// press; a GO in the wait enters the cue that waits.
TEST(Playback, a_cue_that_waits_leaves_what_was_before_as_it_goes) {
    CueList list = threeCues();
    list.cues[1].wait = 3s;
    list.cues[1].look.relays = {1};
    const Playback playback = after(list, {go(0s), go(1s)});
    EXPECT_EQ(stateOf(playback, 1s).cue, 1) << "it is the current one";
    EXPECT_EQ(playback.waitLeftAt(1500ms), 2500ms);
    EXPECT_EQ(playback.waitLeftAt(4s), 0s);
    EXPECT_EQ(playback.fadeLeftAt(1s), 7s);
    EXPECT_THAT(lookOf(playback, 1500ms).levels, ElementsAre(0.75f, 0.0f)) << "the first cue's fade goes on";
    EXPECT_THAT(lookOf(playback, 6s).levels, ElementsAre(0.5f, 0.25f));
    EXPECT_THAT(lookOf(playback, 4s - 1ns).relays, ElementsAre(0));
    EXPECT_THAT(lookOf(playback, 4s).relays, ElementsAre(1));

    const Playback pressed = after(list, {go(0s), go(1s), go(2s)});
    EXPECT_EQ(stateOf(pressed, 2s).cue, 2);
    EXPECT_EQ(lookOf(pressed, 5s), list.cues[2].look) << "the second does not come any more";
}

TEST(Playback, the_parts_of_a_cue_move_in_their_own_time_and_way) {
    CueList list = threeCues();
    list.cues[1].fade = Fade(2s, 8s, Curve::Linear);
    list.cues[1].parts = {{2s, Fade(4s, 4s, Curve::SlowStart), {}, {1}}, {1s, 1s, {}, {}, {}, {{0, {1}}}}};
    const Playback playback = after(list, {go(0s), go(10s)});
    EXPECT_EQ(playback.fadeLeftAt(10s), 8s);
    EXPECT_THAT(lookOf(playback, 11s).outputs[0].layers, ElementsAre(LayerState{0, 0.9375f})) << "it goes out in eight seconds";
    EXPECT_THAT(lookOf(playback, 11500ms).outputs[0].layers, testing::Contains(LayerState{1, 0.5f}));
    EXPECT_THAT(lookOf(playback, 12s).levels, ElementsAre(0.75f, 0.0f)) << "the first goes out in eight, the second waits";
    EXPECT_THAT(lookOf(playback, 14s).levels, ElementsAre(0.5f, 0.125f)) << "a quarter of the way after half of the time";
    EXPECT_EQ(lookOf(playback, 18s).levels, list.cues[1].look.levels);
}

// Example failure: it comes in at its own pace and goes at another, and has too much light in
// between.
TEST(Playback, a_picture_that_stays_keeps_its_light_where_in_and_out_differ) {
    CueList list = threeCues();
    for (const int cue : {0, 1})
        list.cues[static_cast<std::size_t>(cue)].look.outputs[0] = {{{0, 1.0f, Blend::Over}}, {{0, 1, 1.0f}}};
    list.cues[1].fade = Fade(1s, 4s, Curve::Linear);
    const Playback playback = after(list, {go(0s), go(10s)});
    for (const Time time : {Time(10500ms), Time(11s), Time(13s)})
        EXPECT_THAT(lookOf(playback, time).outputs[0].pictures, ElementsAre(ComposedPicture{0, 1, 1.0f})) << seconds(time);
}

// Example failures: the terminal is locked, too, and nobody can unlock; a lock keeps the wall from
// being made dark; a cue does not follow any more.
TEST(Playback, a_lock_takes_cues_from_the_terminal_and_the_show_alone) {
    using Source = Input::Source;
    Playback playback = after(followingCues(), {go(0s), {1s, Input::Kind::Lock}});
    EXPECT_FALSE(stateOf(playback, 1s - 1ns).locked);
    EXPECT_TRUE(stateOf(playback, 1s).locked);
    for (const Source source : {Source::Controller, Source::Contact, Source::Screen}) {
        EXPECT_EQ(playback.apply({.at = 2s, .kind = Input::Kind::Go, .source = source}), Outcome::Locked);
        EXPECT_EQ(playback.apply({.at = 2s, .kind = Input::Kind::Back, .source = source}), Outcome::Locked);
        EXPECT_EQ(playback.apply({.at = 2s, .kind = Input::Kind::Jump, .cue = 2, .source = source}), Outcome::Locked);
    }
    EXPECT_EQ(playback.apply({.at = 2s, .kind = Input::Kind::Dark, .source = Source::Controller}), Outcome::Taken);
    EXPECT_EQ(stateOf(playback, 3s).cue, 1) << "the second follows";
    EXPECT_EQ(playback.apply({.at = 4s, .kind = Input::Kind::Go, .source = Source::Terminal}), Outcome::Taken);
    EXPECT_EQ(playback.apply({.at = 5s, .kind = Input::Kind::Lock}), Outcome::Taken);
    EXPECT_EQ(playback.apply({.at = 5s, .kind = Input::Kind::Back, .source = Source::Controller}), Outcome::Taken);
}

// A slide over a light must not go before the light does: the picture fades as one.
TEST(Playback, a_picture_of_blended_layers_comes_and_goes_as_a_whole) {
    CueList list = threeCues();
    list.cues[0].look.outputs[0] = {{{0, 1.0f}, {1, 0.75f, Blend::Multiply}}, {{0, 2, 1.0f}}};
    list.cues[1].look.outputs[0] = {{{0, 1.0f}}, {}};
    const Playback playback = after(list, {go(10s), go(20s), blackout(30s), jump(40s, 0), blackout(40s), jump(41s, 0)});
    const auto seen = [&](Time time) { return lookOf(playback, time).outputs[0]; };
    const std::vector<LayerState> slide = {{0, 1.0f}, {1, 0.75f, Blend::Multiply}};
    EXPECT_EQ(seen(11s), (OutputState{slide, {{0, 2, 0.5f}}})) << "it comes in two seconds";
    EXPECT_EQ(seen(21s), (OutputState{{{0, 0.25f}, slide[0], slide[1]}, {{1, 3, 0.75f}}})) << "and goes as the light comes";
    EXPECT_EQ(seen(25s), (OutputState{{{0, 1.0f}}, {}}));
    EXPECT_EQ(seen(31s), OutputState{}) << "blackout";
    EXPECT_EQ(seen(42s).pictures, (std::vector<ComposedPicture>{{1, 3, 0.75f}}))
        << "the same look on both sides of a fade is one picture: half of the way, and half of the rest";
}

// A video goes on through the cues that show it and begins anew in one that brings it back.
TEST(Playback, a_layer_begins_when_its_source_comes_onto_the_output) {
    const Playback playback = after(threeCues(), {go(10s), go(20s), go(30s), jump(40s, 0)});
    const auto begun = [&](Time time, std::uint32_t source) -> std::optional<Time> {
        const ShowState state = stateOf(playback, time);
        for (const LayerState& layer : state.outputs[0].layers)
            if (layer.source.value == source) return layer.begun;
        return std::nullopt;
    };
    EXPECT_EQ(begun(15s, 0), 10s);
    EXPECT_EQ(begun(21s, 0), 10s) << "in the fade between two cues that show it";
    EXPECT_EQ(begun(29s, 0), 10s);
    EXPECT_EQ(begun(29s, 1), 20s);
    EXPECT_EQ(begun(31s, 0), std::nullopt) << "the third cue is dark";
    EXPECT_EQ(begun(41s, 0), 40s);
}

TEST(Playback, a_cue_without_fade_is_there_at_once) {
    const Playback playback = after(threeCues(), {jump(5s, 2)});
    EXPECT_EQ(stateOf(playback, 5s - 1ns).cue, -1);
    EXPECT_EQ(lookOf(playback, 5s), threeCues().cues[2].look);
}

// The street is dark for the show's first picture, and lit before its last one has gone.
TEST(Playback, relays_switch_when_their_cue_is_entered) {
    const Playback playback = after(threeCues(), {go(10s), jump(20s, 2)});
    EXPECT_THAT(lookOf(playback, 10s - 1ns).relays, ElementsAre(1));
    EXPECT_THAT(lookOf(playback, 10s).relays, ElementsAre(0));
    EXPECT_THAT(lookOf(playback, 20s).relays, ElementsAre(1));
}

// Example failure: the fade starts from the look that was never reached, and the lamp jumps.
TEST(Playback, a_fade_that_is_interrupted_goes_on_from_where_it_was) {
    const Playback playback = after(threeCues(), {go(10s), go(11s)});
    EXPECT_THAT(lookOf(playback, 11s).levels, ElementsAre(0.5f, 0.0f));
    EXPECT_THAT(lookOf(playback, 11s).outputs[0].layers, ElementsAre(LayerState{0, 0.5f}));
    EXPECT_THAT(lookOf(playback, 13s).levels, ElementsAre(0.25f, 0.25f));
    EXPECT_THAT(lookOf(playback, 13s).outputs[0].layers, ElementsAre(LayerState{0, 0.5f}, LayerState{1, 0.5f}));
    EXPECT_EQ(lookOf(playback, 15s), threeCues().cues[1].look);
}

TEST(Playback, back_enters_the_cue_before_in_that_cues_fade) {
    const Playback playback = after(threeCues(), {go(0s), go(10s), back(20s)});
    EXPECT_EQ(stateOf(playback, 20s).cue, 0);
    EXPECT_THAT(lookOf(playback, 21s).levels, ElementsAre(0.5f, 0.25f));
    EXPECT_EQ(lookOf(playback, 22s), threeCues().cues[0].look);
}

TEST(Playback, jump_enters_any_cue_and_go_goes_on_from_there) {
    const Playback playback = after(threeCues(), {jump(0s, 1), go(10s), jump(20s, 0)});
    EXPECT_EQ(stateOf(playback, 5s).cue, 1);
    EXPECT_EQ(stateOf(playback, 10s).cue, 2);
    EXPECT_EQ(stateOf(playback, 20s).cue, 0);
}

// Example failure: a video of twenty minutes begins when the machine has booted, and not when it
// was to.
TEST(Playback, a_cue_that_was_to_be_entered_before_is_joined) {
    CueList list = threeCues();
    list.cues[0].follow = 10s;
    list.blackoutFade = list.darkFade = 500ms;
    Playback playback(list);
    ASSERT_EQ(playback.apply({.at = 5s, .kind = Input::Kind::Jump, .cue = 0, .ago = 12s}), Outcome::Taken);
    ShowState state = stateOf(playback, 5s + 500ms);
    EXPECT_EQ(state.cue, 1) << "since 3 s";
    EXPECT_EQ(playback.fadeLeftAt(5s), std::max<Time>(list.cues[1].fade.longer() - 2s, 500ms));
    EXPECT_EQ(stateOf(playback, 4s).cue, -1) << "the past stays";
    ASSERT_FALSE(state.outputs[0].layers.empty());
    EXPECT_EQ(state.outputs[0].layers[0].begun, 3s) << "its video is in the middle";
}

TEST(Playback, a_jump_to_the_dark_fades_and_go_begins_anew) {
    CueList list = threeCues();
    list.darkFade = 4s;
    const Playback playback = after(list, {go(0s), go(10s), jump(20s, -1), go(40s)});
    const ShowState lit = stateOf(playback, 20s), fading = stateOf(playback, 22s), dark = stateOf(playback, 24s);
    EXPECT_EQ(fading.cue, -1);
    EXPECT_FLOAT_EQ(lit.levels[1], 0.5f);
    EXPECT_FLOAT_EQ(fading.levels[1], 0.25f);
    EXPECT_EQ(static_cast<const Look&>(dark), list.dark);
    EXPECT_EQ(stateOf(playback, 40s).cue, 0);
}

// A loop of two cues with an exit: GO goes on in the list.
TEST(Playback, cues_that_lead_back_play_in_a_loop_until_go) {
    CueList list = threeCues();
    list.cues[0].follow = list.cues[1].follow = 10s;
    list.cues[1].followers = {0};
    Playback playback = after(list, {go(0s)});
    playback.foresee(1min);
    EXPECT_EQ(stateOf(playback, 35s).cue, 1);
    EXPECT_EQ(stateOf(playback, 45s).cue, 0);
    EXPECT_EQ(stateOf(playback, 45s).next, 1) << "GO's";
    EXPECT_EQ(playback.followerAt(55s), 0);
    playback.foresee(1h);
    EXPECT_EQ(stateOf(playback, 1h - 5s).cue, 1);
    playback.apply(go(1h + 15s));
    EXPECT_EQ(stateOf(playback, 1h + 15s).cue, 2) << "the way out";
}

TEST(Playback, a_loop_may_have_turns) {
    CueList list = threeCues();
    list.cues[0].follow = list.cues[1].follow = 10s;
    list.cues[1].followers = {0};
    list.cues[1].times = 2;
    const auto cueAt = [&](Playback& playback, Time time) { return playback.foresee(time), stateOf(playback, time).cue; };
    Playback playback = after(list, {go(0s)});
    EXPECT_EQ(cueAt(playback, 55s), 1) << "the third time";
    EXPECT_EQ(cueAt(playback, 65s), 2);
    EXPECT_EQ(playback.untilFollowAt(65s), std::nullopt);
    playback.apply(jump(70s, 0));
    EXPECT_EQ(cueAt(playback, 125s), 1) << "it begins to count anew";
    EXPECT_EQ(cueAt(playback, 135s), 2);
    Playback joined = after(list, {{.at = 5s, .kind = Input::Kind::Jump, .ago = 60s}});
    EXPECT_EQ(stateOf(joined, 5s).cue, 2);
}

TEST(Playback, cues_that_follow_by_chance_follow_by_the_seed) {
    CueList list = threeCues();
    for (CueList::Cue& cue : list.cues) {
        cue.follow = 1s;
        cue.followers = {0, 1, 2};
    }
    const auto played = [&](std::uint64_t seed) {
        list.seed = seed;
        Playback playback = after(list, {go(0s)});
        std::vector<int> cues;
        for (Time time = 500ms; time < 60s; time += 1s) playback.foresee(time), cues.push_back(stateOf(playback, time).cue);
        return cues;
    };
    const std::vector<int> cues = played(1);
    EXPECT_EQ(cues, played(1));
    EXPECT_NE(cues, played(2));
    for (int cue = 0; cue < 3; ++cue) EXPECT_GT(std::ranges::count(cues, cue), 10) << cue;
}

TEST(Playback, what_cannot_be_done_is_ignored_and_said) {
    Playback playback(threeCues());
    EXPECT_EQ(playback.apply(back(1s)), Outcome::AtFirstCue);  // there is no cue at all yet
    EXPECT_EQ(playback.apply(go(2s)), Outcome::Taken);
    EXPECT_EQ(playback.apply(back(3s)), Outcome::AtFirstCue);
    EXPECT_EQ(playback.apply(jump(4s, 3)), Outcome::NoSuchCue);
    EXPECT_EQ(playback.apply(jump(4s, -2)), Outcome::NoSuchCue);
    EXPECT_EQ(playback.apply({.at = 4s, .kind = Input::Kind::Jump, .ago = -1s}), Outcome::NoSuchCue);
    EXPECT_EQ(playback.apply(jump(5s, 2)), Outcome::Taken);
    EXPECT_EQ(playback.apply(go(6s)), Outcome::AtLastCue);
    const ShowState state = stateOf(playback, 7s);
    EXPECT_EQ(state.cue, 2);
    EXPECT_EQ(state.inputs, 2u);
    EXPECT_EQ(nameOf(Outcome::AtLastCue), "ignored: this is the last cue");
}

// linux-show-player's users lost cues to a double press. Example failure: every GO restarts the
// interval, and a nervous operator is locked out.
TEST(Playback, go_right_after_a_cue_began_is_ignored) {
    Playback playback(threeCues());
    EXPECT_EQ(playback.apply(go(1s)), Outcome::Taken);
    EXPECT_EQ(playback.apply(go(1150ms)), Outcome::TooSoonAfterCue);
    EXPECT_EQ(playback.apply(go(1299ms)), Outcome::TooSoonAfterCue);
    EXPECT_EQ(playback.apply(go(1300ms)), Outcome::Taken);
    EXPECT_EQ(stateOf(playback, 2s).cue, 1);
    EXPECT_EQ(stateOf(playback, 2s).inputs, 2u);
}

// The operator's GO meets the cue that has just followed by itself. Example failure: it is skipped
// unseen.
TEST(Playback, go_right_after_a_cue_followed_by_itself_is_ignored) {
    Playback playback(followingCues());
    EXPECT_EQ(playback.apply(go(0s)), Outcome::Taken);
    EXPECT_EQ(playback.apply(go(3s + 100ms)), Outcome::TooSoonAfterCue);
    EXPECT_EQ(stateOf(playback, 4s).cue, 1);
    EXPECT_EQ(stateOf(playback, 9s).cue, 2);  // and the ignored GO left the rest of the chain alone
}

// The interval guards GO alone: nothing may delay a blackout or the way back.
TEST(Playback, blackout_and_back_are_taken_at_any_moment) {
    Playback playback = after(threeCues(), {go(1s), go(2s)});
    EXPECT_EQ(playback.apply(blackout(2s + 1ms)), Outcome::Taken);
    EXPECT_EQ(playback.apply(back(2s + 2ms)), Outcome::Taken);
    EXPECT_EQ(playback.apply(blackout(2s + 3ms)), Outcome::Taken);
}

// An emergency button must not turn the light on. Example failure: the operator has blacked out,
// the button is pressed, and it is light.
TEST(Playback, dark_and_light_are_so_whatever_was_before) {
    Playback playback(threeCues());
    const auto isDark = [&](Time at) {
        ShowState state;
        playback.stateAt(at, state);
        return state.blackout;
    };
    for (const auto& [at, kind, dark] : {std::tuple{1s, Input::Kind::Light, false},
                                         {2s, Input::Kind::Dark, true},
                                         {3s, Input::Kind::Dark, true},
                                         {4s, Input::Kind::Blackout, false},
                                         {5s, Input::Kind::Blackout, true},
                                         {6s, Input::Kind::Dark, true},
                                         {7s, Input::Kind::Light, false},
                                         {8s, Input::Kind::Light, false}}) {
        EXPECT_EQ(playback.apply({at, kind}), Outcome::Taken);
        EXPECT_EQ(isDark(at + 900ms), dark) << "after the input at " << at.count() << " s";
    }
}

// A blackout wins over everything in flight. Example failure: a fade started earlier lifts a
// channel afterwards.
TEST(Playback, blackout_overrides_running_fades) {
    const Playback playback = after(threeCues(), {go(10s), blackout(11s)});
    EXPECT_THAT(lookOf(playback, 11s).levels, ElementsAre(0.5f, 0.0f));
    EXPECT_THAT(lookOf(playback, 11250ms).levels, ElementsAre(0.3125f, 0.0f));  // 0.625 of the fade, half of the light
    EXPECT_THAT(lookOf(playback, 11250ms).outputs[0].layers, ElementsAre(LayerState{0, 0.3125f}));
    for (const Time time : {11500ms, 11750ms, 12s + 0ms, 60s + 0ms}) {
        EXPECT_TRUE(stateOf(playback, time).blackout);
        EXPECT_THAT(lookOf(playback, time).levels, Each(0.0f));
        EXPECT_THAT(lookOf(playback, time).outputs[0].layers, IsEmpty());
    }
}

// A dark picture is no reason for dark streets, and none for street lamps that light up the
// audience's darkness.
TEST(Playback, blackout_leaves_relays_to_the_cues) {
    const Playback playback = after(threeCues(), {go(10s), blackout(20s), jump(30s, 2)});
    EXPECT_THAT(lookOf(playback, 25s).relays, ElementsAre(0));
    EXPECT_THAT(lookOf(playback, 30s).relays, ElementsAre(1));
}

// Example failure: a fade that stood still in the dark, or a cue that was lost in it.
TEST(Playback, when_a_blackout_is_given_back_the_show_has_gone_on) {
    const Playback dark = after(threeCues(), {go(10s), blackout(11s), go(12s), blackout(13s)});
    const Playback light = after(threeCues(), {go(10s), go(12s)});
    EXPECT_FALSE(stateOf(dark, 13s).blackout);
    EXPECT_THAT(lookOf(dark, 13s).levels, Each(0.0f));
    EXPECT_FLOAT_EQ(lookOf(dark, 13250ms).levels[0], lookOf(light, 13250ms).levels[0] / 2);
    for (const Time time : {13500ms, 14s + 0ms, 20s + 0ms}) EXPECT_EQ(lookOf(dark, time), lookOf(light, time));
    EXPECT_EQ(stateOf(dark, 20s).cue, 1);
}

TEST(Playback, a_blackout_taken_back_on_the_way_returns_from_where_it_was) {
    const Playback playback = after(threeCues(), {jump(0s, 0), blackout(10s), blackout(10100ms)});
    EXPECT_THAT(lookOf(playback, 10100ms).levels, ElementsAre(FloatNear(0.8f, 1e-6f), 0.0f));
    EXPECT_THAT(lookOf(playback, 10150ms).levels, ElementsAre(FloatNear(0.9f, 1e-6f), 0.0f));
    EXPECT_THAT(lookOf(playback, 10200ms).levels, ElementsAre(FloatNear(1.0f, 1e-6f), 0.0f));
}

TEST(Playback, cues_follow_by_themselves_to_the_end_of_the_chain) {
    const Playback playback = after(followingCues(), {go(10s)});
    EXPECT_EQ(stateOf(playback, 13s - 1ns).cue, 0);
    EXPECT_EQ(stateOf(playback, 13s).cue, 1);
    EXPECT_THAT(lookOf(playback, 15s).levels, ElementsAre(0.5f, 0.25f));
    EXPECT_EQ(stateOf(playback, 18s - 1ns).cue, 1);
    EXPECT_EQ(stateOf(playback, 18s).cue, 2);
    EXPECT_EQ(stateOf(playback, 3600s).cue, 2);
    EXPECT_EQ(stateOf(playback, 3600s).inputs, 1u);  // what follows is derived, not an input
}

// Example failure: the cue that was to follow comes all the same, on top of the operator's.
TEST(Playback, an_input_that_enters_a_cue_calls_off_what_would_have_followed) {
    const Playback playback = after(followingCues(), {go(10s), jump(12s, 2)});
    EXPECT_EQ(stateOf(playback, 12s).cue, 2);
    EXPECT_EQ(stateOf(playback, 100s).cue, 2);
    const Playback again = after(followingCues(), {go(10s), go(12s)});
    EXPECT_EQ(stateOf(again, 16s).cue, 1);  // five seconds from 12 s, not from 13 s
    EXPECT_EQ(stateOf(again, 17s).cue, 2);
}

TEST(Playback, blackout_does_not_call_off_what_follows) {
    EXPECT_EQ(stateOf(after(followingCues(), {go(10s), blackout(11s)}), 14s).cue, 1);
}

TEST(Playback, a_cue_entered_by_back_is_followed_too) {
    const Playback playback = after(followingCues(), {go(0s), back(4s)});
    EXPECT_EQ(stateOf(playback, 4s).cue, 0);
    EXPECT_EQ(stateOf(playback, 7s).cue, 1);
}

// Two devices on two threads may stamp their inputs out of order by a hair; what was shown already
// stays true.
TEST(Playback, an_input_stamped_late_takes_effect_with_its_forerunner) {
    const Playback playback = after(threeCues(), {go(10s), blackout(9s)});
    EXPECT_FALSE(stateOf(playback, 9500ms).blackout);
    EXPECT_TRUE(stateOf(playback, 10s).blackout);
}

// The three properties below hold for any show and any operator, so chance plays both.

CueList randomCues(Rng& rng) {
    constexpr int kOutputs = 2, kSources = 4, kChannels = 3;
    const auto look = [&] {
        Look look;
        look.outputs.resize(kOutputs);
        for (OutputState& output : look.outputs) {
            for (std::uint32_t source = 0; source < kSources; ++source)
                if (rng.uniform() < 0.4) output.layers.push_back({source, static_cast<float>(rng.uniform())});
            if (output.layers.empty() || rng.uniform() < 0.5) continue;
            output.layers.back().blend = static_cast<Blend>(1 + rng.below(3));
            output.pictures.push_back({0, static_cast<std::uint32_t>(output.layers.size()), 1.0f});
        }
        for (int i = 0; i < kChannels; ++i) look.levels.push_back(static_cast<float>(rng.uniform()));
        look.relays.push_back(static_cast<std::uint8_t>(rng.below(2)));
        return look;
    };
    const auto wind = [&] {
        WindWish wish{4 * rng.uniform(), rng.uniform(), std::nullopt};
        if (rng.uniform() < 0.7) wish.direction = rng.uniform(-2 * std::numbers::pi, 2 * std::numbers::pi);
        return wish;
    };
    CueList list;
    list.seed = rng.bits();
    list.dark = {std::vector<OutputState>(kOutputs), std::vector<float>(kChannels, 0.0f), {1}};
    list.goInterval = 300ms;
    list.blackoutFade = list.darkFade = 500ms;
    for (std::uint32_t i = 0, count = 2 + rng.below(5); i < count; ++i) {
        const auto fade = [&] {
            return Fade(fromSeconds(0.5 + 3 * rng.uniform()), fromSeconds(0.5 + 3 * rng.uniform()),
                        static_cast<Curve>(rng.below(4)));
        };
        CueList::Cue cue{look(), fade(), std::nullopt};
        if (rng.uniform() < 0.3) cue.wait = fromSeconds(2 * rng.uniform());
        if (rng.uniform() < 0.5) cue.parts = {{fromSeconds(2 * rng.uniform()), fade(), {0}, {1}}};
        for (int output = 0; output < kOutputs; ++output) cue.winds.push_back(wind());
        if (i + 1 < count && rng.uniform() < 0.4) cue.follow = fromSeconds(5 * rng.uniform());
        list.cues.push_back(std::move(cue));
    }
    return list;
}

std::vector<Input> randomInputs(Rng& rng, std::size_t count) {
    std::vector<Input> inputs;
    Time at{};
    while (inputs.size() < count) {
        at += fromSeconds(2 * rng.uniform() * rng.uniform());
        inputs.push_back({at, static_cast<Input::Kind>(rng.below(4)), static_cast<int>(rng.below(8)) - 1});
    }
    return inputs;
}

// A seek, a restart and a second machine show the same frame. Asks the same moments in order while
// the inputs come in, as a night does, and in a random order afterwards. Example failure: a fade
// that is advanced from query to query.
TEST(Playback, the_state_depends_on_time_and_inputs_alone) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        Rng rng(seed);
        const CueList list = randomCues(rng);
        const std::vector<Input> inputs = randomInputs(rng, 60);
        constexpr Time kFrame = 33ms;

        Playback live(list);
        std::vector<ShowState> seen;
        auto next = inputs.begin();
        for (Time time{}; time < inputs.back().at + 10s; time += kFrame) {
            for (; next != inputs.end() && next->at <= time; ++next) live.apply(*next);
            seen.push_back(stateOf(live, time));
        }

        Playback replay(list);
        for (const Input& input : inputs) replay.apply(input);
        ShowState state;  // reused, so that what it held before must not show
        for (int i = 0; i < 300; ++i) {
            const std::size_t frame = rng.below(static_cast<std::uint32_t>(seen.size()));
            replay.stateAt(static_cast<std::int64_t>(frame) * kFrame, state);
            ASSERT_EQ(state, seen[frame]) << "seed " << seed << ", frame " << frame;
        }
    }
}

// Nothing jumps: between two moments no level and no opacity moves faster than the quickest fade
// allows.
// Example failure: an interrupted fade or a blackout over one that starts from a look instead of
// from what is seen.
TEST(Playback, no_level_and_no_opacity_ever_steps) {
    for (std::uint64_t seed = 100; seed < 120; ++seed) {
        Rng rng(seed);
        const CueList list = randomCues(rng);
        const std::vector<Input> inputs = randomInputs(rng, 60);
        Playback playback(list);
        for (const Input& input : inputs) playback.apply(input);

        // A change of the light multiplies: its rate and the fade's add up at most.
        double rate = 1 / seconds(list.blackoutFade), quickest = 0;
        const auto rateOf = [](const Fade& fade) {
            constexpr double kSteepest = 2;  // of the curves
            return kSteepest / seconds(std::min(fade.in, fade.out));
        };
        for (const CueList::Cue& cue : list.cues) {
            quickest = std::max(quickest, rateOf(cue.fade));
            for (const CueList::Part& part : cue.parts) quickest = std::max(quickest, rateOf(part.fade));
        }
        rate += quickest;
        constexpr Time kStep = 5ms;
        const double allowed = rate * seconds(kStep) + 1e-6;
        Look before = lookOf(playback, 0s);
        for (Time time = kStep; time < inputs.back().at + 5s; time += kStep) {
            const Look now = lookOf(playback, time);
            for (std::size_t i = 0; i < now.levels.size(); ++i)
                ASSERT_LE(std::abs(now.levels[i] - before.levels[i]), allowed) << seed;
            for (std::size_t output = 0; output < now.outputs.size(); ++output)
                for (std::uint32_t source = 0; source < 4; ++source)
                    ASSERT_LE(std::abs(opacity(now, output, source) - opacity(before, output, source)), allowed) << seed;
            before = now;
        }
    }
}

// The wind goes without a jump, and without a jerk, through every cue, cuts among them, whatever it
// interrupts; and no wind that was not asked for. Example failure: a wind that fades like a level,
// whose rate jumps; a cut that is a cut for the wind too.
TEST(Playback, neither_a_wind_nor_its_rate_of_change_ever_steps) {
    for (std::uint64_t seed = 300; seed < 310; ++seed) {
        Rng rng(seed);
        CueList list = randomCues(rng);
        for (std::size_t i = 0; i < list.cues.size(); i += 2) list.cues[i].fade = Time{};
        const std::vector<Input> inputs = randomInputs(rng, 40);
        Playback playback(list);
        for (const Input& input : inputs) playback.apply(input);
        double strongest = 1;
        for (const CueList::Cue& cue : list.cues)
            for (const WindWish& wish : cue.winds) strongest = std::max(strongest, wish.strength);

        // Four numbers of two outputs. None changes by more than 4 within a fifth of a second or
        // so, and its rate of change takes as long: a step would be all of that within 1 ms.
        using Numbers = std::vector<double>;
        const auto numbers = [&](Time time) {
            Numbers all;
            for (const Wind& wind : stateOf(playback, time).winds)
                all.insert(all.end(), {wind.strength, wind.ownDirection, wind.direction.x, wind.direction.y});
            return all;
        };
        constexpr Time kStep = 1ms;
        Numbers before = numbers(-2 * kStep), last = numbers(-kStep);
        for (Time time{}; time < inputs.back().at + 5s; time += kStep) {
            const Numbers now = numbers(time);
            for (std::size_t i = 0; i < now.size(); ++i) {
                ASSERT_LE(std::abs(now[i] - last[i]), 0.02) << "seed " << seed << " at " << seconds(time);
                ASSERT_LE(std::abs((now[i] - last[i]) - (last[i] - before[i])), 5e-5)
                    << "seed " << seed << " at " << seconds(time);
                if (i % 4 == 0) {
                    ASSERT_TRUE(now[i] >= 0 && now[i] <= strongest) << now[i];
                }
            }
            before = std::exchange(last, now);
        }
    }
}

// Example failure: one wind for all, that of the last output.
TEST(Playback, a_wind_stays_on_its_output) {
    CueList list = threeCues();
    for (CueList::Cue& cue : list.cues) cue.look.outputs.resize(2);
    list.dark.outputs.resize(2);
    list.cues[0].winds = {{3, 0, std::nullopt}, {0, 0, 0.5}};
    const ShowState state = stateOf(after(list, {go(0s)}), 60s);
    ASSERT_EQ(state.winds.size(), 2u);
    EXPECT_NEAR(state.winds[0].strength, 3, 1e-9);
    EXPECT_NEAR(state.winds[0].ownDirection, 1, 1e-9);
    EXPECT_NEAR(state.winds[1].strength, 0, 1e-9);
    EXPECT_NEAR(state.winds[1].direction.x, std::cos(0.5), 1e-9);
}

// A show without a word of wind is the show that it was.
TEST(Playback, without_a_wind_patterns_sway_as_they_are) {
    const Playback playback = after(threeCues(), {go(0s), go(1s), jump(5s, 0)});
    for (const Time time : {-1s, 0s, 2s, 60s}) EXPECT_THAT(stateOf(playback, time).winds, ElementsAre(Wind{}));
}

// The renderer is handed what it can draw: no source twice, no layer without light, nothing out of
// range.
TEST(Playback, every_state_is_well_formed) {
    for (std::uint64_t seed = 200; seed < 220; ++seed) {
        Rng rng(seed);
        Playback playback(randomCues(rng));
        for (const Input& input : randomInputs(rng, 60)) playback.apply(input);
        for (int i = 0; i < 300; ++i) {
            const Look look = lookOf(playback, fromSeconds(rng.uniform(0, 60)));
            for (const OutputState& output : look.outputs) {
                for (const LayerState& layer : output.layers) {
                    EXPECT_GT(layer.opacity, 0);
                    EXPECT_LE(layer.opacity, 1);
                }
                const auto allDiffer = [&](std::size_t first, std::size_t last) {
                    std::set<SourceId> sources;
                    for (std::size_t i = first; i < last; ++i) sources.insert(output.layers[i].source);
                    return sources.size() == last - first;
                };
                std::size_t end = addedOnes(output);
                EXPECT_TRUE(allDiffer(0, end)) << seed;
                for (std::size_t i = 0; i < end; ++i) EXPECT_EQ(output.layers[i].blend, Blend::Add);
                double shares = 0;
                for (const ComposedPicture& picture : output.pictures) {
                    EXPECT_EQ(picture.first, end) << seed;
                    EXPECT_GT(picture.last, picture.first);
                    EXPECT_GT(picture.share, 0);
                    EXPECT_TRUE(allDiffer(picture.first, picture.last)) << seed;
                    shares += double{picture.share};
                    end = picture.last;
                }
                EXPECT_EQ(end, output.layers.size());
                EXPECT_LE(shares, 1 + 1e-5);
            }
            for (const float level : look.levels) EXPECT_TRUE(level >= 0 && level <= 1) << level;
        }
    }
}

// Cues that follow each other for ever are worked out as far as somebody asks. Example failures:
// the program never returns from the first GO; at hour ten the list is a moment off, or its levels
// are.
TEST(Playback, a_list_that_loops_goes_on_for_ever) {
    CueList list = followingCues();
    list.loops = true;
    list.cues[2].follow = 2s;
    Playback playback(list);
    ASSERT_EQ(playback.apply(go(0s)), Outcome::Taken);
    const Time pass = 10s;
    const std::vector<std::pair<Time, int>> moments{{0s, 0}, {2s, 0}, {3s, 1}, {7s, 1}, {8s, 2}};
    playback.foresee(2 * pass);
    std::vector<Look> looks;
    for (const auto& [into, cue] : moments) looks.push_back(lookOf(playback, pass + into));
    playback.foresee(10h + pass);
    for (std::size_t i = 0; i < moments.size(); ++i) {
        const auto& [into, cue] = moments[i];
        EXPECT_EQ(stateOf(playback, 10h + into).cue, cue) << seconds(into);
        EXPECT_EQ(lookOf(playback, 10h + into), looks[i]) << seconds(into);
    }
    EXPECT_EQ(playback.untilFollowAt(10h + 1s), 2s);
    EXPECT_EQ(playback.apply(jump(10h + 4s, 2)), Outcome::Taken);
    EXPECT_EQ(stateOf(playback, 10h + 4s).cue, 2) << "whoever presses goes on from there";
    EXPECT_EQ(stateOf(playback, 10h + 6s).cue, 0);
    EXPECT_EQ(playback.apply(jump(11h, 2)), Outcome::Taken);
    EXPECT_EQ(playback.apply(go(11h + 1s)), Outcome::Taken);
    EXPECT_EQ(stateOf(playback, 11h + 1s).cue, 0) << "GO at the last cue begins anew";
}

// Example failure: a show that loops for thirty nights fills the memory.
TEST(Playback, a_list_that_loops_forgets_what_is_long_over) {
    CueList list = followingCues();
    list.loops = true;
    list.cues[2].follow = 2s;
    Playback playback(list);
    playback.apply(go(0s));
    playback.foresee(1h);
    const std::size_t before = mallinfo2().uordblks;
    playback.foresee(101h);
    EXPECT_LT(mallinfo2().uordblks, before + 20000) << "36000 more passes";
    EXPECT_EQ(stateOf(playback, 101h - 9min).cue, stateOf(playback, 101h + 1min).cue) << "ten minutes are kept";
    EXPECT_EQ(lookOf(playback, 0s), lookOf(playback, 1h)) << "of a time that is forgotten, what was seen first since";
}

// The render thread asks for a state with every frame and must not wait for the heap.
TEST(Playback, asking_again_allocates_nothing) {
    Rng rng(7);
    Playback playback(randomCues(rng));
    const std::vector<Input> inputs = randomInputs(rng, 300);
    for (const Input& input : inputs) playback.apply(input);
    ShowState state;
    playback.stateAt(0s, state);
    const std::int64_t before = allocationsSoFar();
    for (Time time{}; time < inputs.back().at; time += 33ms) playback.stateAt(time, state);
    EXPECT_EQ(allocationsSoFar(), before);
    EXPECT_GT(before, 0u);
}

}  // namespace
}  // namespace fantascope::show
