// Exchanges of a source's pattern: inputs that bring another one without a jump.

#include "show/pattern_exchange.h"

#include "show/play/input.h"
#include "show/play/playback.h"

#include <gmock/gmock.h>

#include <cmath>
#include <string>
#include <vector>

namespace fantascope::show {
namespace {

using namespace std::chrono_literals;

constexpr SourceId kLeaves{0}, kOther{1};

// One output that shows a source's pattern; an exchange takes 4 s.
Playback leaves() {
    CueList list;
    CueList::Cue cue;
    cue.look.outputs = {OutputState{{LayerState{kLeaves, 1.0f}}}};
    cue.name = "One";
    list.cues = {cue};
    list.dark.outputs = {OutputState{}};
    list.exchangeFade = 4s;
    Playback playback(std::move(list));
    EXPECT_EQ(playback.apply({.at = 1s, .kind = Input::Kind::Go}), Outcome::Taken);
    return playback;
}

Input exchange(Time at, int number, int source = 0) {
    return {.at = at, .kind = Input::Kind::Exchange, .source = Input::Source::Camera, .which = source, .revision = number};
}
Input toggle(Time at) { return {.at = at, .kind = Input::Kind::Corrections}; }

PatternExchange seenAt(const Playback& playback, Time time) {
    ShowState state;
    playback.stateAt(time, state);
    return state.outputs[0].layers.at(0).exchange;
}

TEST(PatternExchange, brings_the_new_pattern_in_the_time_of_the_site_file) {
    Playback playback = leaves();
    EXPECT_EQ(seenAt(playback, 9s), PatternExchange{});
    EXPECT_EQ(playback.apply(exchange(10s, 1)), Outcome::Taken);
    EXPECT_EQ(seenAt(playback, 10s), (PatternExchange{1, 1, 0}));
    EXPECT_EQ(seenAt(playback, 12s), (PatternExchange{1, 0.5f, 0}));
    EXPECT_EQ(seenAt(playback, 14s), (PatternExchange{1, 0, 0}));
    EXPECT_EQ(seenAt(playback, 14s).newest(), 1);
    EXPECT_EQ(seenAt(playback, 5s), PatternExchange{}) << "the past does not change";

    EXPECT_EQ(playback.apply(exchange(20s, 2)), Outcome::Taken);
    EXPECT_EQ(seenAt(playback, 20s), (PatternExchange{2, 0, 1}));
    EXPECT_EQ(seenAt(playback, 22s), (PatternExchange{2, 0, 0.5f}));
    EXPECT_EQ(seenAt(playback, 24s), (PatternExchange{2, 0, 0}));
}

// Example failure: a second exchange during the first makes the pattern jump.
TEST(PatternExchange, does_not_jump_whatever_comes_when) {
    Playback playback = leaves();
    for (const Input& input : {exchange(10s, 1), exchange(11s, 2), toggle(12s), toggle(13s), exchange(13100ms, 2),
                               exchange(30s, 3), toggle(31s), toggle(32s), exchange(32s, 4)})
        EXPECT_EQ(playback.apply(input), Outcome::Taken);
    // The shares of the own pattern and of those of the exchanges.
    const auto shares = [&](Time time) {
        const PatternExchange seen = seenAt(playback, time);
        std::vector<float> all(6, 0.0f);
        all[0] += seen.original;
        if (seen.number > 0) all[static_cast<std::size_t>(seen.number - 1)] += seen.previous;
        all[static_cast<std::size_t>(seen.number)] += seen.number > 0 ? seen.newest() : 0;
        return all;
    };
    std::vector<float> before = shares(9s);
    int moving = 0;
    for (Time time = 9s; time < 60s; time += 20ms) {
        const std::vector<float> now = shares(time);
        for (std::size_t i = 0; i < now.size(); ++i) EXPECT_LT(std::abs(now[i] - before[i]), 0.01f) << seconds(time);
        moving += now != before ? 1 : 0;
        before = now;
    }
    EXPECT_GT(moving, 1000);
    EXPECT_EQ(seenAt(playback, 1h), (PatternExchange{4, 0, 0}));
}

TEST(PatternExchange, is_taken_back_by_one_press_and_comes_again_after_the_next) {
    Playback playback = leaves();
    playback.apply(exchange(10s, 1));
    playback.apply(exchange(20s, 2));
    EXPECT_EQ(playback.apply(toggle(30s)), Outcome::Taken);
    EXPECT_EQ(seenAt(playback, 30s), (PatternExchange{2, 0, 0}));
    EXPECT_EQ(seenAt(playback, 32s), (PatternExchange{2, 0.5f, 0}));
    EXPECT_EQ(seenAt(playback, 34s), (PatternExchange{2, 1, 0}));
    EXPECT_EQ(playback.apply(exchange(35s, 2)), Outcome::CorrectionsOff);
    playback.apply(toggle(40s));
    EXPECT_EQ(seenAt(playback, 50s), (PatternExchange{2, 1, 0})) << "nothing comes by itself";
    EXPECT_EQ(playback.apply(exchange(50s, 2)), Outcome::Taken);
    EXPECT_EQ(seenAt(playback, 54s), (PatternExchange{2, 0, 0}));
}

TEST(PatternExchange, is_ignored_if_its_pattern_is_not_the_next_one) {
    Playback playback = leaves();
    EXPECT_EQ(playback.apply(exchange(10s, 2)), Outcome::NoSuchPattern);
    EXPECT_EQ(playback.apply(exchange(10s, 0)), Outcome::NoSuchPattern);
    EXPECT_EQ(playback.apply(exchange(10s, 1, 7)), Outcome::NoSuchPattern);
    EXPECT_EQ(playback.apply(exchange(10s, 1, -1)), Outcome::NoSuchPattern);
    EXPECT_EQ(playback.apply(exchange(10s, 1)), Outcome::Taken);
    EXPECT_EQ(playback.apply(exchange(20s, 1)), Outcome::NoSuchPattern) << "it is seen already";
    EXPECT_EQ(seenAt(playback, 1h), (PatternExchange{1, 0, 0}));
}

TEST(PatternExchange, is_a_line_of_a_journal) {
    const Input input = exchange(12500ms, 3, 2);
    EXPECT_EQ(lineOf(input), "12500000000 exchange 3 camera 2");
    const auto read = inputOf(lineOf(input));
    ASSERT_TRUE(read) << read.error().message();
    EXPECT_EQ(*read, input);
}

// Each source has its own exchanges.
TEST(PatternCourses, keep_the_sources_apart) {
    PatternCourses courses;
    EXPECT_TRUE(courses.exchange(kLeaves, 1, 10s, 2s));
    EXPECT_FALSE(courses.exchange(kOther, 2, 10s, 2s));
    EXPECT_TRUE(courses.exchange(kOther, 1, 20s, 2s));
    EXPECT_EQ(courses.at(kOther, 15s), PatternExchange{});
    EXPECT_EQ(courses.at(kLeaves, 15s), (PatternExchange{1, 0, 0}));
    courses.takeBack(30s, 2s);
    EXPECT_EQ(courses.at(kLeaves, 40s), (PatternExchange{1, 1, 0}));
    EXPECT_EQ(courses.at(kOther, 40s), (PatternExchange{1, 1, 0}));
}

}  // namespace
}  // namespace fantascope::show
