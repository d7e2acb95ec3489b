// Cues that change how sources play, and cues that wait for the end of what plays.

#include "played.h"

#include <gmock/gmock.h>

#include <utility>

namespace fantascope::show {
namespace {

using namespace std::chrono_literals;

constexpr SourceId kRain{0}, kBird{1};

CueList::Cue showing(std::vector<SourceId> sources, Fade fade) {
    CueList::Cue cue{.look = {{{}}, {}, {}}, .fade = fade, .follow = {}};
    for (const SourceId source : sources) cue.look.outputs[0].layers.push_back({source, 1});
    return cue;
}

CueList listOf(std::vector<CueList::Cue> cues) {
    CueList list;
    list.dark = {{{}}, {}, {}};
    list.cues = std::move(cues);
    return list;
}

// For how long a source has played on the only output.
Time playedAt(const Playback& playback, Time time, SourceId source = kRain) {
    const ShowState state = stateOf(playback, time);
    for (const LayerState& layer : state.outputs[0].layers)
        if (layer.source == source) return state.cueTime - layer.behind - layer.begun;
    ADD_FAILURE() << "it is not seen at " << seconds(time) << " s";
    return Time::min();
}

constexpr Input goAt(Time at) { return {.at = at, .kind = Input::Kind::Go}; }

// Example failures: the position jumps when the speed changes; the speed changes at once.
TEST(SourcePlay, a_cue_changes_the_speed_of_what_plays_in_its_fade) {
    CueList list = listOf({showing({kRain, kBird}, 0s), showing({kRain, kBird}, 4s), showing({kRain, kBird}, 0s)});
    list.cues[1].speeds = {{kRain, 0}};
    list.cues[2].speeds = {{kRain, 2}};
    const Playback playback = after(list, {goAt(10s), goAt(20s), goAt(30s)});
    EXPECT_EQ(playedAt(playback, 19s), 9s);
    EXPECT_EQ(playedAt(playback, 22s), 11500ms) << "of the two seconds 1.5 are played";
    EXPECT_EQ(playedAt(playback, 24s), 12s);
    EXPECT_EQ(playedAt(playback, 29s), 12s) << "it stands";
    EXPECT_EQ(playedAt(playback, 33s), 18s);
    EXPECT_EQ(playedAt(playback, 33s, kBird), 23s) << "another one plays as before";
}

TEST(SourcePlay, the_change_waits_as_its_cue_does) {
    CueList list = listOf({showing({kRain}, 0s), showing({kRain}, 0s)});
    list.cues[1].wait = 5s;
    list.cues[1].speeds = {{kRain, 0}};
    list.cues[1].parts = {{.wait = 1s, .fade = {}, .outputs = {0}}};
    const Playback playback = after(list, {goAt(0s), goAt(10s)});
    EXPECT_EQ(playedAt(playback, 15s), 15s);
    EXPECT_EQ(playedAt(playback, 18s), 15s);
}

// Example failure: a video that comes slowly begins at full speed.
TEST(SourcePlay, what_comes_has_its_speed_from_the_first) {
    CueList list = listOf({showing({}, 0s), showing({kRain}, 4s)});
    list.cues[1].speeds = {{kRain, 0.5f}};
    const Playback playback = after(list, {goAt(0s), goAt(10s)});
    EXPECT_EQ(playedAt(playback, 12s), 1s);
    EXPECT_EQ(playedAt(playback, 18s), 4s);
    Playback late(list);
    ASSERT_EQ(late.apply({.at = 20s, .kind = Input::Kind::Jump, .cue = 1, .ago = 10s}), Outcome::Taken);
    EXPECT_EQ(playedAt(late, 20s), 5s) << "as if it had been there";
}

TEST(SourcePlay, a_source_begins_again_with_the_cue_that_says_so) {
    CueList list = listOf({showing({kRain}, 0s), showing({kRain}, 2s), showing({kRain}, 0s)});
    list.cues[1].restarts = {kRain};
    list.cues[1].wait = 3s;
    const Playback playback = after(list, {goAt(0s), goAt(10s), goAt(20s)});
    EXPECT_EQ(playedAt(playback, 12s), 12s);
    EXPECT_EQ(playedAt(playback, 13s), 0s);
    EXPECT_EQ(playedAt(playback, 24s), 11s) << "the next cue does not";
}

TEST(SourcePlay, a_revision_begins_nothing_again) {
    CueList list = listOf({showing({kRain}, 0s), showing({kRain}, 2s)});
    list.cues[0].name = "A";
    list.cues[1].name = "B";
    list.cues[1].restarts = {kRain};
    Playback playback = after(list, {goAt(0s), goAt(10s)});
    ASSERT_EQ(playback.apply({.at = 15s, .kind = Input::Kind::Revise}, std::make_shared<const CueList>(list)), Outcome::Taken);
    EXPECT_EQ(playedAt(playback, 16s), 6s);
}

// A cue that is followed two seconds after its video of six seconds has ended.
CueList mediaList() {
    CueList list = listOf({showing({kRain}, 1s), showing({}, 0s), showing({kRain}, 0s)});
    list.cues[0].follow = 2s;
    list.cues[0].endings = {{kRain, 6s}};
    return list;
}

TEST(MediaFollow, waits_for_the_end_of_what_plays) {
    const Playback playback = after(mediaList(), {goAt(10s)});
    EXPECT_EQ(playback.untilFollowAt(11s), 7s);
    EXPECT_EQ(stateOf(playback, 18s - 1ns).cue, 0);
    EXPECT_EQ(stateOf(playback, 18s).cue, 1);
}

// Example failure: the length counts from the cue, although the video has begun before.
TEST(MediaFollow, counts_what_has_played_before_and_how_fast_it_plays) {
    CueList list = mediaList();
    list.cues.insert(list.cues.begin(), showing({kRain}, 0s));
    const Playback soon = after(list, {goAt(0s), goAt(4s)});
    EXPECT_EQ(stateOf(soon, 8s - 1ns).cue, 1);
    EXPECT_EQ(stateOf(soon, 8s).cue, 2);
    list.cues[1].speeds = {{kRain, 0.5f}};  // within 1 s .75 s are played, and then 1.25 s take 2.5 s
    const Playback slow = after(list, {goAt(0s), goAt(4s)});
    EXPECT_EQ(stateOf(slow, 9500ms - 1us).cue, 1);
    EXPECT_EQ(stateOf(slow, 9500ms + 1us).cue, 2);
}

TEST(MediaFollow, does_not_come_while_the_source_stands) {
    CueList list = mediaList();
    list.cues[0].speeds = {{kRain, 0}};
    EXPECT_EQ(after(list, {goAt(0s)}).untilFollowAt(1s), std::nullopt);
}

TEST(MediaFollow, waits_for_the_fade_and_for_its_parts_too) {
    CueList list = mediaList();
    list.cues[0].fade = 20s;
    EXPECT_EQ(stateOf(after(list, {goAt(0s)}), 22s - 1ns).cue, 0);
    EXPECT_EQ(stateOf(after(list, {goAt(0s)}), 22s).cue, 1);
    list.cues[0].fade = 0s;
    list.cues[0].parts = {{.wait = 3s, .fade = {}, .layers = {{0, kRain}}}};
    const Playback late = after(list, {goAt(0s)});
    EXPECT_EQ(stateOf(late, 11s - 1ns).cue, 0) << "it comes after three seconds";
    EXPECT_EQ(stateOf(late, 11s).cue, 1);
}

// Example failure: a circle around a video that is over follows itself for ever.
TEST(MediaFollow, a_circle_takes_its_least_time) {
    CueList list = listOf({showing({kRain}, 0s)});
    list.cues[0].follow = 0s;
    list.cues[0].endings = {{kRain, 1s}};
    list.loops = true;
    Playback playback = after(list, {goAt(0s)});
    playback.foresee(20s);
    EXPECT_EQ(playback.untilFollowAt(500ms), 500ms);
    EXPECT_GE(playback.untilFollowAt(10s).value(), 0s);
    EXPECT_LE(playback.untilFollowAt(10s).value(), kShortestLoop);
    list.cues[0].restarts = {kRain};
    Playback again = after(list, {goAt(0s)});
    again.foresee(20s);
    EXPECT_EQ(playedAt(again, 7500ms), 500ms) << "with a restart it plays again and again";
}

TEST(MediaFollow, who_joins_late_is_where_the_show_would_be) {
    Playback late(mediaList());
    ASSERT_EQ(late.apply({.at = 20s, .kind = Input::Kind::Jump, .cue = 0, .ago = 5s}), Outcome::Taken);
    EXPECT_EQ(playedAt(late, 20s), 5s);
    EXPECT_EQ(late.untilFollowAt(20s), 3s);
    Playback later(mediaList());
    ASSERT_EQ(later.apply({.at = 20s, .kind = Input::Kind::Jump, .cue = 0, .ago = 8s}), Outcome::Taken);
    EXPECT_EQ(stateOf(later, 20s).cue, 1);
}

}  // namespace
}  // namespace fantascope::show
