// A show that is changed while it plays: the new cue list comes as an input and plays on from what
// is seen.

#include "show/revision.h"

#include "show/play/input_log.h"
#include "show/play/playback.h"
#include "show/replaced.h"

#include "scratch_folder.h"

#include <gmock/gmock.h>

#include <memory>
#include <sstream>
#include <string>
#include <vector>

namespace fantascope::show {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;

// One output, one channel and one relay. Each cue shows its source and level alone; all fade in
// four seconds.
CueList::Cue cue(const std::string& name, std::uint32_t source, float level) {
    return {{{{{{source, 1.0f}}}}, {level}, {0}}, 4s, std::nullopt, {}, name};
}

std::shared_ptr<const CueList> listOf(std::vector<CueList::Cue> cues) {
    CueList list;
    list.cues = std::move(cues);
    list.dark = {{{}}, {0.0f}, {1}};
    list.goInterval = 300ms;
    list.blackoutFade = 500ms;
    return std::make_shared<const CueList>(std::move(list));
}

std::shared_ptr<const CueList> asFirstRead() { return listOf({cue("Dusk", 0, 0.25f), cue("Night", 1, 0.5f), cue("End", 2, 1)}); }

constexpr Input go(Time at) { return {at, Input::Kind::Go}; }
constexpr Input revise(Time at) { return {at, Input::Kind::Revise}; }

float levelAt(const Playback& playback, Time time) {
    ShowState state;
    playback.stateAt(time, state);
    return state.levels[0];
}
int cueAt(const Playback& playback, Time time) {
    ShowState state;
    playback.stateAt(time, state);
    return state.cue;
}

// Example failures: the second cue of the new list goes on, which is another one; the light jumps.
TEST(Revision, the_cue_of_the_same_name_goes_on_and_fades_to_its_new_look) {
    Playback playback(asFirstRead());
    playback.apply(go(0s));
    playback.apply(go(10s));
    const auto changed = listOf({cue("Dusk", 0, 0.25f), cue("Rain", 3, 0.1f), cue("Night", 1, 1), cue("End", 2, 1)});
    ASSERT_EQ(playback.apply(revise(20s), changed), Outcome::Taken);
    EXPECT_EQ(cueAt(playback, 20s - 1ns), 1) << "what was seen stays as it was";
    EXPECT_EQ(levelAt(playback, 20s - 1ns), 0.5f);
    EXPECT_EQ(cueAt(playback, 20s), 2);
    EXPECT_EQ(levelAt(playback, 20s), 0.5f);
    EXPECT_FLOAT_EQ(levelAt(playback, 20s + 250ms), 0.75f) << "the cue's own fade is over: within the blackout fade";
    EXPECT_EQ(levelAt(playback, 20s + 500ms), 1);
    ShowState state;
    playback.stateAt(21s, state);
    EXPECT_THAT(state.outputs[0].layers, ElementsAre(LayerState{1, 1.0f, Blend::Add, 10s})) << "a video goes on";
    EXPECT_EQ(state.inputs, 3u);
    playback.apply(go(22s));
    EXPECT_EQ(cueAt(playback, 22s), 3);
    EXPECT_EQ(levelAt(playback, 30s), 1);
}

// Example failure: who saves a file in the middle of a fade sees the fade begin again.
TEST(Revision, that_changes_nothing_changes_nothing_that_is_seen) {
    Playback plain(asFirstRead()), revised(asFirstRead());
    for (Playback* playback : {&plain, &revised}) {
        playback->apply(go(0s));
        playback->apply(go(10s));
    }
    ASSERT_EQ(revised.apply(revise(11s), asFirstRead()), Outcome::Taken);
    for (Time time = 0s; time < 20s; time += 50ms) {
        ShowState one, other;
        plain.stateAt(time, one);
        revised.stateAt(time, other);
        EXPECT_NEAR(one.levels[0], other.levels[0], 1e-6);
        ASSERT_EQ(one.outputs[0].layers.size(), other.outputs[0].layers.size()) << seconds(time);
        for (std::size_t i = 0; i < one.outputs[0].layers.size(); ++i)
            EXPECT_NEAR(one.outputs[0].layers[i].opacity, other.outputs[0].layers[i].opacity, 1e-6);
        EXPECT_EQ(plain.fadeLeftAt(time), revised.fadeLeftAt(time));
    }
}

// Example failure: somebody takes the running cue out, and the street goes dark, or the cue before
// comes back.
TEST(Revision, without_the_running_cue_leaves_what_is_seen_until_go) {
    Playback playback(asFirstRead());
    playback.apply(go(0s));
    playback.apply(go(10s));
    std::vector<CueList::Cue> cues = {cue("Dusk", 0, 0.25f), cue("End", 2, 1)};
    cues[0].follow = 1s;
    playback.apply(revise(20s), listOf(cues));
    playback.apply(revise(25s), listOf(cues));
    EXPECT_EQ(levelAt(playback, 40s), 0.5f);
    EXPECT_EQ(cueAt(playback, 40s), 0);
    EXPECT_EQ(playback.untilFollowAt(40s), std::nullopt) << "that was of another cue";
    playback.apply(go(50s));
    EXPECT_EQ(cueAt(playback, 50s), 1);
    EXPECT_EQ(levelAt(playback, 54s), 1);
}

TEST(Revision, lets_a_cue_follow_on_as_the_new_list_says) {
    const auto following = [](Time after) {
        std::vector<CueList::Cue> cues = asFirstRead()->cues;
        cues[0].follow = after;
        return listOf(cues);
    };
    Playback later(following(10s)), overdue(following(10s));
    later.apply(go(0s));
    later.apply(revise(5s), following(20s));
    EXPECT_EQ(cueAt(later, 20s - 1ns), 0);
    EXPECT_EQ(cueAt(later, 20s), 1) << "counted from when the cue was entered";
    overdue.apply(go(0s));
    overdue.apply(revise(5s), following(2s));
    EXPECT_EQ(cueAt(overdue, 5s - 1ns), 0);
    EXPECT_EQ(cueAt(overdue, 5s), 1);
    overdue.apply(revise(6s), asFirstRead());
    EXPECT_EQ(cueAt(overdue, 100s), 1);
}

TEST(Revision, that_is_not_there_or_for_another_site_is_told_and_changes_nothing) {
    Playback playback(asFirstRead());
    playback.apply(go(0s));
    EXPECT_EQ(playback.apply(revise(1s)), Outcome::NoSuchRevision);
    CueList wider = *asFirstRead();
    wider.dark.levels.push_back(0);
    for (CueList::Cue& cue : wider.cues) cue.look.levels.push_back(1);
    EXPECT_EQ(playback.apply(revise(1s), std::make_shared<const CueList>(wider)), Outcome::OtherSite);
    ShowState state;
    playback.stateAt(2s, state);
    EXPECT_EQ(state.levels.size(), 1u);
    EXPECT_EQ(state.inputs, 1u);
}

// Example failures: a replica that began late plays the newest list from the beginning; a replay of
// what was written plays the first list to the end.
TEST(Revision, is_an_input_that_every_replica_takes_at_the_same_moment) {
    const auto changed = listOf({cue("Dusk", 3, 0.75f), cue("Night", 1, 0.5f)});
    std::string written;
    const auto statesOf = [](const InputLog& log) {
        Playback playback(log.cues());
        InputLog::Reader reader = log.reader();
        while (const LoggedInput* const logged = reader.next())
            EXPECT_EQ(playback.apply(logged->input, logged->revision), logged->outcome);
        std::vector<ShowState> states(200);
        for (std::size_t i = 0; i < states.size(); ++i) playback.stateAt(Time(i * 100ms), states[i]);
        return states;
    };
    InputLog log(asFirstRead());
    const int number = log.add(changed);
    EXPECT_EQ(number, 1);
    EXPECT_EQ(statesOf(log), statesOf(InputLog(asFirstRead()))) << "it changes nothing by itself";
    for (const Input& input : {go(0s), Input{.at = 4s, .kind = Input::Kind::Revise, .revision = 2},
                               Input{.at = 5s, .kind = Input::Kind::Revise, .revision = -1},
                               Input{.at = 6s, .kind = Input::Kind::Revise, .revision = number}, go(8s), go(9s)})
        written += lineOf(log.submit(input).input) + '\n';
    EXPECT_THAT(written, testing::HasSubstr("\n6000000000 revise 1 start 0\n"));
    const std::vector<ShowState> states = statesOf(log);
    EXPECT_EQ(states[59].levels[0], 0.25f);
    EXPECT_EQ(states[70].levels[0], 0.75f);
    EXPECT_EQ(states[199].cue, 1) << "the last GO was at the new list's last cue";

    InputLog again(asFirstRead());
    again.add(changed);
    std::istringstream lines(written);
    for (std::string line; std::getline(lines, line);) again.submit(inputOf(line).value());
    EXPECT_EQ(statesOf(again), states);
}

constexpr std::string_view kShow = R"(fantascope: show
version: 1
title: Test
sources: {red: {solid: [1, 0, 0]}, blue: {solid: [0, 0, 1]}}
looks: {all: {outputs: {wall: [{source: red}, {source: blue}]}}}
cues: [{name: Dusk, look: all, fade: 2}]
)";

Site oneOutput() {
    Site site;
    site.file = "site.yaml";
    site.outputs.resize(1);
    site.outputs[0].name = site.outputs[0].canvas = "wall";
    return site;
}

// Example failure: a source that is written above the others makes every layer show its neighbour.
TEST(Revision, names_sources_by_ids_that_stay_wherever_they_stand_in_the_file) {
    ScratchFolder folder;
    SourceNames names;
    const auto file = folder.file("show.yaml", std::string(kShow));
    const auto before = Revision::of(Show::load(file, names).value(), oneOutput()).value();
    const std::string moved = "sources: {green: {solid: [0, 1, 0]}, blue: {solid: [0, 0, 1]}, red: {solid: [1, 0, 0]}}";
    folder.file("show.yaml", replaced(std::string(kShow), "sources: {red: {solid: [1, 0, 0]}, blue: {solid: [0, 0, 1]}}", moved));
    const auto after = Revision::of(Show::load(file, names).value(), oneOutput()).value();
    EXPECT_EQ(before->cues.cues[0].look, after->cues.cues[0].look);
    EXPECT_EQ(after->show.sources[0].id, SourceId{2});
    EXPECT_EQ(after->show.sources[1].id, before->show.sources[1].id);
    EXPECT_EQ(after->show.sources[2].id, before->show.sources[0].id);
}

// Example failure: what plays still needs what a newer revision has replaced.
TEST(Revision, lives_as_long_as_anybody_plays_its_cues) {
    ScratchFolder folder;
    auto revision = Revision::of(Show::load(folder.file("show.yaml", std::string(kShow))).value(), oneOutput()).value();
    const std::weak_ptr<const Revision> watched = revision;
    auto playback = std::make_unique<Playback>(Revision::cuesOf(revision));
    revision.reset();
    ASSERT_FALSE(watched.expired());
    playback->apply(go(0s));
    EXPECT_EQ(playback->cues().cues[0].name, "Dusk");
    playback.reset();
    EXPECT_TRUE(watched.expired());
}

}  // namespace
}  // namespace fantascope::show
