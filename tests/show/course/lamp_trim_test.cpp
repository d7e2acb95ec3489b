// Trims of the site's own lamps: inputs that let them give less, slowly and within bounds.

#include "show/course/lamp_trim.h"

#include "show/patch.h"
#include "show/play/input.h"
#include "show/play/playback.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

namespace fantascope::show {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;

// A spot that may be dimmed, a fountain of colours that may be dimmed, a moving head whose
// intensity alone may be, a lamp that may not; and two relays that may be switched off, the second
// one first.
Site trimmedSite() {
    Site site;
    site.fixtures = {{"spot", 1, 1, {"intensity"}},
                     {"fountain", 1, 10, {"red", "green"}},
                     {"head", 1, 20, {"pan", "intensity", "red"}},
                     {"sign", 1, 30, {"intensity"}}};
    site.relayBanks = {{"street", {}}};
    site.relays = {{"road", 0, 0, true}, {"path", 0, 1, true}, {"gate", 0, 2, true}};
    site.corrections.lamps.fixtures = {0, 1, 2};
    site.corrections.lamps.relays = {1, 0};
    return site;
}

// Trims down to 0.2, by 0.1 a second; relays stay for a minute.
Playback oneCue() {
    CueList list;
    list.dark = {{{}}, std::vector<float>(7, 0), {1, 1, 1}};
    list.cues = {{{{{}}, std::vector<float>(7, 1), {1, 1, 1}}, 0s, std::nullopt, {}, "One"},
                 {{{{}}, std::vector<float>(7, 0.5f), {1, 1, 1}}, 0s, std::nullopt, {}, "Two"}};
    list.trim = {0.2f, 0.1, 2, 1min};
    return Playback(std::move(list));
}

Input trim(Time at, float share, int relaysOff = 0) {
    return {.at = at, .kind = Input::Kind::Trim, .source = Input::Source::Camera, .trim = {share, relaysOff}};
}
Input press(Time at, Input::Kind kind) { return {.at = at, .kind = kind}; }

ShowState stateAt(const Playback& playback, Time time) {
    ShowState state;
    playback.stateAt(time, state);
    return state;
}
float shareAt(const Playback& playback, Time time) { return stateAt(playback, time).lamps.share; }
int offAt(const Playback& playback, Time time) { return stateAt(playback, time).lamps.relaysOff; }

TEST(LampTrim, moves_at_its_speed_from_where_it_is) {
    Playback playback = oneCue();
    EXPECT_EQ(playback.apply(trim(10s, 0.5f)), Outcome::Taken);
    EXPECT_EQ(shareAt(playback, 10s), 1);
    EXPECT_NEAR(shareAt(playback, 12s), 0.8f, 1e-6);
    playback.apply(trim(12s, 1));
    EXPECT_NEAR(shareAt(playback, 13s), 0.9f, 1e-6) << "it does not jump to the goal of before";
    EXPECT_EQ(shareAt(playback, 14s), 1);
    EXPECT_NEAR(shareAt(playback, 11s), 0.9f, 1e-6) << "the past stays";
}

TEST(LampTrim, beyond_what_the_site_allows_is_ignored) {
    Playback playback = oneCue();
    for (const auto& [share, off] : {std::pair{0.19f, 0}, {1.01f, 0}, {0.5f, 3}, {0.5f, -1}})
        EXPECT_EQ(playback.apply(trim(0s, share, off)), Outcome::TooFar) << share << ", " << off;
    EXPECT_EQ(stateAt(playback, 1min).lamps, LampTrim{});
    Playback none(CueList{.cues = {{{{{}}, {}, {}}, 0s, std::nullopt, {}, "One"}}, .dark = {{{}}, {}, {}}});
    EXPECT_EQ(none.apply(trim(0s, 0.9f)), Outcome::TooFar) << "a list without bounds allows none";
}

TEST(LampTrim, keeps_relays_as_they_are_for_a_while) {
    Playback playback = oneCue();
    EXPECT_EQ(playback.apply(trim(0s, 1, 1)), Outcome::Taken);
    EXPECT_EQ(playback.apply(trim(59s, 1, 0)), Outcome::RelaysHeld);
    EXPECT_EQ(playback.apply(trim(59s, 0.5f, 1)), Outcome::Taken) << "the fixtures may go on";
    EXPECT_EQ(offAt(playback, 59s), 1);
    EXPECT_EQ(playback.apply(trim(60s, 0.5f, 2)), Outcome::Taken);
    EXPECT_EQ(offAt(playback, 60s), 2);
}

// A dark picture is no reason for dark streets. Example failure: somebody presses the emergency
// button, and the path stays dark.
TEST(LampTrim, gives_the_relays_back_in_a_blackout_and_for_a_while_after_it) {
    Playback playback = oneCue();
    playback.apply(trim(0s, 0.5f, 2));
    playback.apply(press(5s, Input::Kind::Dark));
    EXPECT_EQ(offAt(playback, 5s), 0);
    EXPECT_NEAR(shareAt(playback, 5s), 0.5f, 1e-6) << "the fixtures are dark anyway";
    EXPECT_EQ(playback.apply(trim(2min, 0.5f, 1)), Outcome::RelaysHeld);
    playback.apply(press(2min, Input::Kind::Light));
    EXPECT_EQ(offAt(playback, 2min), 0);
    EXPECT_EQ(playback.apply(trim(2min + 1s, 0.5f, 1)), Outcome::Taken);
}

TEST(LampTrim, is_taken_back_by_the_key_for_all_corrections) {
    Playback playback = oneCue();
    playback.apply(trim(0s, 0.5f, 1));
    EXPECT_EQ(playback.apply(press(10s, Input::Kind::Corrections)), Outcome::Taken);
    EXPECT_EQ(offAt(playback, 10s), 0) << "whatever they are held for";
    EXPECT_NEAR(shareAt(playback, 12s), 0.7f, 1e-6);
    EXPECT_EQ(shareAt(playback, 15s), 1);
    EXPECT_EQ(playback.apply(trim(20s, 0.5f)), Outcome::CorrectionsOff);
    playback.apply(press(80s, Input::Kind::Corrections));
    EXPECT_EQ(playback.apply(trim(80s, 0.5f)), Outcome::Taken);
}

TEST(LampTrim, does_not_depend_on_cues) {
    Playback playback = oneCue();
    playback.apply(press(0s, Input::Kind::Go));
    playback.apply(trim(1s, 0.5f));
    playback.apply(press(10s, Input::Kind::Go));
    EXPECT_NEAR(shareAt(playback, 10s), 0.5f, 1e-6);
    EXPECT_EQ(stateAt(playback, 10s).levels[0], 0.5f) << "as the cue asks; the trim comes on top";
}

TEST(LampTrim, scales_what_gives_light_of_the_listed_fixtures_and_switches_listed_relays_off) {
    Look look{{}, {1, 0.8f, 0.4f, 0.6f, 1, 0.2f, 1}, {1, 1, 1}};
    applyTrim(trimmedSite(), {0.5f, 1}, look);
    EXPECT_THAT(look.levels, ElementsAre(0.5f, 0.4f, 0.2f, 0.6f, 0.5f, 0.2f, 1)) << "a moving head does not turn";
    EXPECT_THAT(look.relays, ElementsAre(1, 0, 1)) << "in the order of the list";
    look.relays = {0, 0, 0};
    applyTrim(trimmedSite(), {}, look);
    EXPECT_THAT(look.relays, ElementsAre(0, 0, 0)) << "it never switches one on";
}

// At the highest speed that a site file may ask for, no 8-bit slot jumps, and no finer one moves by
// more than a tenth of a percent of full light from one DMX frame to the next.
TEST(LampTrim, is_too_slow_to_be_seen_from_frame_to_frame) {
    constexpr double kFastest = 0.05, kFrames = 40;  // 1/s; Hz
    TrimCourses courses;
    courses.want({0, 0}, 1s, kFastest);
    const Site site = trimmedSite();
    int before = 255;
    float shareBefore = 1;
    for (int frame = 0; frame < 30 * kFrames; ++frame) {
        const LampTrim now = courses.at(tickTime(frame, kFrames));
        Look look{{}, std::vector<float>(7, 1), {1, 1, 1}};
        applyTrim(site, now, look);
        std::array<std::uint8_t, 512> slots{};
        slotsOf(site, look, 1, slots);
        EXPECT_LE(std::abs(slots[0] - before), 1) << frame;
        EXPECT_LE(std::abs(now.share - shareBefore), kFastest / kFrames + 1e-6) << frame;
        before = slots[0];
        shareBefore = now.share;
    }
    EXPECT_EQ(before, 0) << "a test of nothing";
}

TEST(LampTrim, is_a_line_of_a_journal) {
    const Input input = trim(12500ms, 0.4375f, 2);
    EXPECT_EQ(lineOf(input), "12500000000 trim 0 camera 0 0.4375 2");
    const auto read = inputOf(lineOf(input));
    ASSERT_TRUE(read) << read.error().message();
    EXPECT_EQ(*read, input);
    Input odd = trim(1s, 0.1f + 0.2f / 3);
    EXPECT_EQ(*inputOf(lineOf(odd)), odd) << "to the last bit";
    for (const std::string bad : {"1 trim 0 camera 0", "1 trim 0 camera 0 0.5", "1 trim 0 camera 0 0.5 1 2",
                                  "1 trim 0 camera 0 nan 1", "1 trim 0 camera 0 0.5 1.5", "1 go 0 camera 0 0.5 1"})
        EXPECT_FALSE(inputOf(bad)) << bad;
}

}  // namespace
}  // namespace fantascope::show
