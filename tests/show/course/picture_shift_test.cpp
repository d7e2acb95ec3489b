// Corrections of where an output's picture stands: inputs that move it slowly, within bounds.

#include "show/course/picture_shift.h"

#include "show/play/input.h"
#include "show/play/playback.h"

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <limits>
#include <string>
#include <vector>

namespace fantascope::show {
namespace {

using namespace std::chrono_literals;

// Two outputs; corrections of up to 10 pixels, at 4 pixels a second.
Playback twoOutputs() {
    CueList list;
    list.cues = {{{{{}, {}}, {}, {}}, 0s, std::nullopt, {}, "One"}};
    list.dark = {{{}, {}}, {}, {}};
    list.farthestShift = 10;
    list.shiftSpeed = 4;
    return Playback(std::move(list));
}

PictureShift all(float x, float y) { return {glm::vec2(x, y), glm::vec2(x, y), glm::vec2(x, y), glm::vec2(x, y)}; }

Input correct(Time at, int output, const PictureShift& shift) {
    return {.at = at, .kind = Input::Kind::Correct, .source = Input::Source::Camera, .which = output, .shift = shift};
}

PictureShift shiftAt(const Playback& playback, std::size_t output, Time time) {
    ShowState state;
    playback.stateAt(time, state);
    return state.shifts[output];
}

bool allowedAt(const Playback& playback, Time time) {
    ShowState state;
    playback.stateAt(time, state);
    return state.corrects;
}

TEST(Corrections, move_a_picture_at_the_speed_of_its_fastest_corner) {
    Playback playback = twoOutputs();
    PictureShift shift = all(0, 0);
    shift[1] = {8, 0};
    shift[2] = {0, -2};
    EXPECT_EQ(playback.apply(correct(10s, 1, shift)), Outcome::Taken);
    EXPECT_EQ(shiftAt(playback, 1, 10s), all(0, 0));
    EXPECT_EQ(shiftAt(playback, 1, 11s)[1], glm::vec2(4, 0));
    EXPECT_EQ(shiftAt(playback, 1, 11s)[2], glm::vec2(0, -1));
    EXPECT_EQ(shiftAt(playback, 1, 12s), shift);
    EXPECT_EQ(shiftAt(playback, 1, 1h), shift);
    EXPECT_EQ(shiftAt(playback, 0, 1h), all(0, 0));
}

// Example failure: the second one begins at the goal of the first one, and the picture jumps.
TEST(Corrections, go_on_from_where_the_picture_is) {
    Playback playback = twoOutputs();
    playback.apply(correct(0s, 0, all(8, 0)));
    playback.apply(correct(1s, 0, all(-8, 0)));
    PictureShift before = shiftAt(playback, 0, 0s);
    for (Time time = 0s; time < 8s; time += 10ms) {
        const PictureShift now = shiftAt(playback, 0, time);
        for (std::size_t i = 0; i < now.size(); ++i) EXPECT_LE(glm::distance(now[i], before[i]), 0.0401f) << seconds(time);
        before = now;
    }
    EXPECT_EQ(before, all(-8, 0));
}

TEST(Corrections, do_not_change_what_was_seen_before) {
    Playback playback = twoOutputs();
    playback.apply(correct(0s, 0, all(8, 0)));
    const PictureShift before = shiftAt(playback, 0, 500ms);
    playback.apply(correct(1s, 0, all(0, 0)));
    EXPECT_EQ(shiftAt(playback, 0, 500ms), before);
}

TEST(Corrections, are_ignored_beyond_what_the_site_allows) {
    Playback playback = twoOutputs();
    EXPECT_EQ(playback.apply(correct(0s, 0, all(8, 7))), Outcome::TooFar);
    EXPECT_EQ(playback.apply(correct(0s, 2, all(1, 0))), Outcome::NoSuchOutput);
    EXPECT_EQ(playback.apply(correct(0s, -1, all(1, 0))), Outcome::NoSuchOutput);
    EXPECT_EQ(shiftAt(playback, 0, 1min), all(0, 0));
}

TEST(Corrections, are_taken_back_by_one_press_and_allowed_by_the_next) {
    Playback playback = twoOutputs();
    playback.apply(correct(0s, 0, all(8, 0)));
    playback.apply(correct(0s, 1, all(0, 4)));
    EXPECT_EQ(playback.apply({.at = 10s, .kind = Input::Kind::Corrections}), Outcome::Taken);
    EXPECT_EQ(shiftAt(playback, 0, 11s), all(4, 0));
    EXPECT_EQ(shiftAt(playback, 0, 12s), all(0, 0));
    EXPECT_EQ(shiftAt(playback, 1, 12s), all(0, 0));
    EXPECT_EQ(playback.apply(correct(20s, 0, all(8, 0))), Outcome::CorrectionsOff);
    EXPECT_TRUE(allowedAt(playback, 9s));
    EXPECT_FALSE(allowedAt(playback, 10s));
    EXPECT_EQ(playback.apply({.at = 30s, .kind = Input::Kind::Corrections}), Outcome::Taken);
    EXPECT_EQ(playback.apply(correct(40s, 0, all(8, 0))), Outcome::Taken);
    EXPECT_FALSE(allowedAt(playback, 29s));
    EXPECT_TRUE(allowedAt(playback, 30s));
    EXPECT_EQ(shiftAt(playback, 0, 1min), all(8, 0));
}

TEST(Corrections, are_maps_of_the_projectors_pixels) {
    const PictureShift shift = {glm::vec2(3, -2), {-4, 1}, {2, 5}, {-1, -6}};
    const auto map = mapOf(shift, {640, 360});
    ASSERT_TRUE(map);
    EXPECT_LT(glm::distance((*map)({640, 0}), glm::dvec2(636, 1)), 1e-9);
    const PictureShift again = shiftOf(*map, {640, 360});
    for (std::size_t i = 0; i < shift.size(); ++i) EXPECT_LT(glm::distance(again[i], shift[i]), 1e-4f) << i;
    EXPECT_FALSE(mapOf({glm::vec2(700, 400), {}, {}, {}}, {640, 360})) << "it would fold the picture";
}

TEST(Corrections, are_lines_of_a_journal) {
    Input input = correct(12500ms, 1, all(1.5f, -0.1f));
    input.shift[3] = {1e-7f, 1234.5678f};
    const auto read = inputOf(lineOf(input));
    ASSERT_TRUE(read) << read.error().message();
    EXPECT_EQ(*read, input);
    const std::string line = lineOf(input);
    for (const std::string& bad :
         std::vector<std::string>{line + " 1", line.substr(0, line.rfind(' ')), "1 correct 0 camera 0",
                                  "1 go 0 camera 0 1 2 3 4 5 6 7 8", "1 correct 0 camera 0 nan 2 3 4 5 6 7 8",
                                  "1 correct 0 camera 0 1 inf 3 4 5 6 7 8", "1 correct 0 camera 0 1 x 3 4 5 6 7 8"})
        EXPECT_FALSE(inputOf(bad)) << bad;
}

}  // namespace
}  // namespace fantascope::show
