// Lists that play beside each other, and what they show together.

#include "show/play/playback.h"
#include "show/play/played.h"

#include <gmock/gmock.h>

namespace fantascope::show {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr Input go(Time at, int list = 0) { return {.at = at, .kind = Input::Kind::Go, .list = list}; }
constexpr Input jump(Time at, int cue, int list = 0) { return {.at = at, .kind = Input::Kind::Jump, .cue = cue, .list = list}; }

CueList::Cue cue(float level, std::uint8_t relay, std::vector<LayerState> layers = {}) {
    return {.look = {{{std::move(layers)}}, {level}, {relay}}, .fade = 2s, .follow = {}};
}

// One output, one channel, one relay that is safe when on. The main list has two cues, the side
// list two others.
CueList twoLists() {
    CueList side;
    side.dark = {{{}}, {0.0f}, {1}};
    side.cues = {cue(0.5f, 1, {{0, 0.75f}}), cue(1.0f, 0)};
    side.blackoutFade = side.darkFade = 500ms;
    side.name = "Bar";
    CueList list = side;
    list.name.clear();
    list.cues = {cue(0.25f, 0, {{0, 0.5f}, {1, 1.0f}}), cue(0.75f, 0)};
    list.sides.push_back(std::make_shared<const CueList>(std::move(side)));
    return list;
}
CueList withSide(CueList list, const std::function<void(CueList&)>& change) {
    CueList side = *list.sides[0];
    change(side);
    list.sides[0] = std::make_shared<const CueList>(std::move(side));
    return list;
}

ShowState seen(Playback& playback, Time time) {
    playback.foresee(time);
    return stateOf(playback, time);
}

TEST(SideLists, go_goes_to_the_list_that_it_names) {
    Playback playback = after(twoLists(), {go(0s), go(10s, 1), go(20s, 1)});
    EXPECT_EQ(seen(playback, 5s).cue, 0);
    EXPECT_EQ(seen(playback, 5s).sides[0].cue, -1);
    EXPECT_EQ(seen(playback, 5s).sides[0].next, 0);
    EXPECT_EQ(seen(playback, 15s).cue, 0);
    EXPECT_EQ(seen(playback, 15s).sides[0].cue, 0);
    EXPECT_EQ(seen(playback, 25s).sides[0].cue, 1);
    EXPECT_EQ(seen(playback, 25s).next, 1);
    EXPECT_EQ(playback.apply(go(30s, 1)), Outcome::AtLastCue);
    EXPECT_EQ(playback.apply(go(30s, 2)), Outcome::NoSuchList);
    EXPECT_EQ(playback.apply(go(30s, -1)), Outcome::NoSuchList);
    EXPECT_EQ(playback.apply({.at = 30s, .kind = Input::Kind::Load, .cue = 0, .list = 1}), Outcome::Taken);
    EXPECT_EQ(seen(playback, 30s).sides[0].loaded, 0);
    EXPECT_EQ(seen(playback, 30s).loaded, -1);
}

TEST(SideLists, a_press_in_one_list_does_not_make_one_in_another_too_soon) {
    CueList list = twoLists();
    list.goInterval = 300ms;
    Playback playback = after(list, {go(0s), go(100ms, 1)});
    EXPECT_EQ(playback.apply(go(200ms)), Outcome::TooSoonAfterCue);
}

TEST(SideLists, the_highest_level_and_opacity_count) {
    Playback playback = after(twoLists(), {go(0s), go(10s, 1), go(20s)});
    EXPECT_THAT(seen(playback, 5s).levels, ElementsAre(0.25f));
    EXPECT_THAT(seen(playback, 11s).levels, ElementsAre(0.25f)) << "the side is as high in the middle of its fade";
    const ShowState both = seen(playback, 15s);
    EXPECT_THAT(both.levels, ElementsAre(0.5f));
    EXPECT_THAT(both.outputs[0].layers, ElementsAre(LayerState{0, 0.75f, Blend::Add, Time{}}, LayerState{1, 1.0f}))
        << "it plays since the main list has shown it";
    EXPECT_THAT(seen(playback, 25s).levels, ElementsAre(0.75f));
    EXPECT_THAT(seen(playback, 25s).outputs[0].layers, ElementsAre(LayerState{0, 0.75f, Blend::Add, 10s}));
}

TEST(SideLists, composed_pictures_add_their_light) {
    CueList list = twoLists();
    const OutputState over{{{0, 1.0f, Blend::Over}}, {{0, 1}}};
    list.cues[0].look.outputs[0] = over;
    list = withSide(list, [&](CueList& side) {
        side.cues[0].look.outputs[0] = over;
        side.cues[1].look.outputs[0] = {{{2, 0.5f}}};
    });
    Playback playback = after(list, {go(0s), go(0s, 1), go(10s, 1)});
    const OutputState both = seen(playback, 5s).outputs[0], one = seen(playback, 15s).outputs[0];
    EXPECT_THAT(both.pictures, ElementsAre(ComposedPicture{0, 1}, ComposedPicture{1, 2}));
    EXPECT_THAT(one.layers, ElementsAre(LayerState{2, 0.5f, Blend::Add, 10s}, LayerState{0, 1.0f, Blend::Over}));
    EXPECT_THAT(one.pictures, ElementsAre(ComposedPicture{1, 2})) << "light that adds comes first";
}

TEST(SideLists, a_relay_is_as_the_list_has_it_that_named_it_last) {
    CueList list = twoLists();
    list.cues[1].tracksRelays = {1};
    Playback playback = after(list, {go(0s), go(10s, 1), go(20s), jump(30s, -1, 1)});
    EXPECT_THAT(seen(playback, 5s).relays, ElementsAre(0));
    EXPECT_THAT(seen(playback, 15s).relays, ElementsAre(1));
    EXPECT_THAT(seen(playback, 25s).relays, ElementsAre(1)) << "the main list's second cue does not name it";
    EXPECT_THAT(seen(playback, 35s).relays, ElementsAre(0)) << "a list that is dark has no say";
    playback.apply(jump(40s, 0));
    playback.apply(jump(50s, -1));
    EXPECT_THAT(seen(playback, 45s).relays, ElementsAre(0));
    EXPECT_THAT(seen(playback, 55s).relays, ElementsAre(1)) << "safe";
}

TEST(SideLists, start_when_the_main_list_leaves_the_dark_and_end_with_it) {
    CueList list = withSide(twoLists(), [](CueList& side) { side.start = 1; });
    Playback playback = after(list, {go(10s), go(20s), jump(30s, -1), go(40s)});
    const auto sideAt = [&](Time time) { return seen(playback, time).sides[0].cue; };
    EXPECT_EQ(sideAt(5s), -1);
    EXPECT_EQ(sideAt(10s), 1);
    EXPECT_EQ(sideAt(25s), 1);
    EXPECT_EQ(sideAt(30s), -1);
    EXPECT_EQ(sideAt(40s), 1);
    EXPECT_THAT(seen(playback, 39s).levels, ElementsAre(0.0f));
}

// Groups that go at once: one GO, or one follow, starts things in several lists.
TEST(SideLists, a_cue_brings_cues_of_other_lists) {
    CueList list = withSide(twoLists(), [](CueList& side) { side.start = 0; });
    list.cues[0].with = {{0, 1}};
    list.cues[0].follow = 5s;
    list.cues[1].with = {{0, -1}};
    list.cues[1].wait = 3s;
    Playback playback = after(list, {go(10s)});
    const auto sideAt = [&](Time time) { return seen(playback, time).sides[0].cue; };
    EXPECT_EQ(sideAt(10s), 1) << "instead of its start";
    EXPECT_EQ(sideAt(15s - 1ns), 1);
    EXPECT_EQ(sideAt(15s), -1) << "with the follow, before its wait is over";
    EXPECT_EQ(seen(playback, 15s).cue, 1);
}

// What a follow is to bring has been worked out when an input comes before it.
// Example failure: the bar goes dark at a time at which the main list is elsewhere.
TEST(SideLists, what_was_foreseen_is_taken_back_by_an_input) {
    CueList list = twoLists();
    list.cues[0].follow = 5s;
    list.cues[1].with = {{0, 1}};
    for (const bool foreseen : {false, true}) {
        Playback playback = after(list, {go(0s), go(1s, 1)});
        if (foreseen) playback.foresee(6s);
        playback.apply(jump(4s, 0));
        EXPECT_EQ(seen(playback, 6s).sides[0].cue, 0) << foreseen;
        EXPECT_EQ(seen(playback, 9s).sides[0].cue, 1) << foreseen;
        playback.foresee(30s);
        playback.apply({.at = 8s, .kind = Input::Kind::Jump, .cue = 0, .list = 1});
        EXPECT_EQ(seen(playback, 8500ms).sides[0].cue, 0) << foreseen;
        EXPECT_EQ(seen(playback, 9s).sides[0].cue, 1) << foreseen << ": the follow brings it all the same";
    }
}

// Cues that follow at the same moment all bring theirs.
TEST(SideLists, a_chain_of_cues_at_one_moment_brings_what_each_names) {
    CueList list = twoLists();
    list.sides.push_back(list.sides[0]);
    list.cues[0].follow = 0s;
    list.cues[0].with = {{0, 1}};
    list.cues[1].with = {{1, 0}};
    Playback playback = after(list, {go(3s)});
    const ShowState state = seen(playback, 3s);
    EXPECT_EQ(state.cue, 1);
    EXPECT_EQ(state.sides[0].cue, 1);
    EXPECT_EQ(state.sides[1].cue, 0);
}

// A machine that starts in the middle of a night.
TEST(SideLists, join_late_with_the_main_list) {
    CueList list = withSide(twoLists(), [](CueList& side) {
        side.start = 0;
        side.cues[0].follow = 7s;
    });
    list.cues[0].follow = 10s;
    Playback playback(list);
    ASSERT_EQ(playback.apply({.at = 0s, .kind = Input::Kind::Jump, .ago = 12s}), Outcome::Taken);
    const ShowState state = seen(playback, 0s);
    EXPECT_EQ(state.cue, 1);
    EXPECT_EQ(state.sides[0].cue, 1) << "since 5 s";
    list.cues[1].with = {{0, 0}};
    Playback brought(list);
    ASSERT_EQ(brought.apply({.at = 0s, .kind = Input::Kind::Jump, .ago = 12s}), Outcome::Taken);
    EXPECT_EQ(seen(brought, 4s).sides[0].cue, 0);
    EXPECT_EQ(seen(brought, 5s).sides[0].cue, 1) << "2 of 7 s had gone";
}

TEST(SideLists, pause_freeze_and_blackout_hold_all_lists) {
    CueList list = withSide(twoLists(), [](CueList& side) { side.cues[0].follow = 10s; });
    Playback paused =
        after(list, {go(0s), go(0s, 1), {.at = 5s, .kind = Input::Kind::Pause}, {.at = 65s, .kind = Input::Kind::Pause}});
    EXPECT_EQ(seen(paused, 64s).sides[0].cue, 0);
    EXPECT_EQ(seen(paused, 70s).sides[0].cue, 1);
    Playback frozen = after(list, {go(0s), go(0s, 1), {.at = 5s, .kind = Input::Kind::Freeze}});
    EXPECT_EQ(seen(frozen, 30s).sides[0].cue, 1);
    EXPECT_THAT(seen(frozen, 30s).levels, ElementsAre(0.5f)) << "as at 5 s";
    frozen.apply(jump(40s, -1, 1));
    EXPECT_TRUE(seen(frozen, 41s).frozen) << "a side in the dark is no end of the night";
    Playback dark = after(list, {go(0s), go(0s, 1), {.at = 5s, .kind = Input::Kind::Dark}});
    EXPECT_THAT(seen(dark, 15s).levels, ElementsAre(0.0f));
    EXPECT_THAT(seen(dark, 15s).outputs[0].layers, IsEmpty());
}

TEST(SideLists, each_list_goes_on_after_a_revision_and_other_lists_are_refused) {
    CueList list = twoLists();
    for (CueList* const each : {&list}) each->cues[0].name = "a", each->cues[1].name = "b";
    list = withSide(list, [](CueList& side) { side.cues[0].name = "warm", side.cues[1].name = "cool"; });
    Playback playback = after(list, {go(0s), go(0s, 1)});
    const auto revised = std::make_shared<const CueList>(withSide(list, [](CueList& side) {
        side.cues.insert(side.cues.begin(), cue(0.1f, 1));
        side.cues[1].look.levels = {0.9f};
    }));
    const Input revise{.at = 10s, .kind = Input::Kind::Revise, .revision = 1};
    ASSERT_EQ(playback.apply(revise, revised), Outcome::Taken);
    EXPECT_EQ(seen(playback, 15s).sides[0].cue, 1) << "'warm'";
    EXPECT_THAT(seen(playback, 15s).levels, ElementsAre(0.9f));
    EXPECT_EQ(seen(playback, 15s).cue, 0);
    EXPECT_EQ(playback.apply(revise, std::make_shared<const CueList>(withSide(list, [](CueList& side) { side.name = "Foyer"; }))),
              Outcome::OtherLists);
}

TEST(SideLists, the_wind_is_moved_by_the_list_that_names_it) {
    CueList list = withSide(twoLists(), [](CueList& side) { side.cues[0].winds = {{.strength = 3}}; });
    list.cues[0].winds = {{.strength = 0}};
    Playback mainMoves = after(list, {go(0s), go(0s, 1)});
    EXPECT_NEAR(seen(mainMoves, 20s).winds[0].strength, 0, 1e-9);
    list.windLists = {1};
    Playback sideMoves = after(list, {go(0s), go(0s, 1)});
    EXPECT_NEAR(seen(sideMoves, 20s).winds[0].strength, 3, 1e-9);
}

}  // namespace
}  // namespace fantascope::show
