// Whole nights in simulation, through all of the watch.

#include "drawn_night.h"

#include <gmock/gmock.h>

#include <algorithm>

namespace fantascope::app {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

// "left: dead output".
std::vector<std::string> causesOf(const NightResult& night) {
    std::vector<std::string> causes;
    for (const CauseReport& cause : night.causes)
        causes.push_back((cause.output.empty() ? "" : cause.output + ": ") + cause.cause);
    return causes;
}

TEST(DrawnNight, names_each_cause_in_turn_and_says_when_it_is_over) {
    NightOptions options;
    options.seed = 3;
    options.outputs = 2;
    options.camera = {400, 225};
    options.script = {"kind: dim, output: NAME, at: 12, until: 18, level: 0.5", "kind: fog, at: 24, until: 30, density: 0.04",
                      "kind: input, output: NAME, at: 37, until: 42, picture: menu.png"};
    options.length = 48;
    const NightResult night = playNight(options);
    ASSERT_THAT(causesOf(night),
                ElementsAre(night.outputs[0] + ": dim projector lamp", "fog", night.outputs[0] + ": wrong input"));
    const std::vector<std::pair<double, double>> true_times{{12, 18}, {24, 30}, {37, 42}};
    for (std::size_t i = 0; i < night.causes.size(); ++i) {
        EXPECT_NEAR(seconds(night.causes[i].from), true_times[i].first, 1.6) << i;
        ASSERT_TRUE(night.causes[i].to) << i;
        EXPECT_NEAR(seconds(*night.causes[i].to), true_times[i].second, 1.6) << i;
    }
}

// People walk by, and a lamp changes with the cues.
TEST(DrawnNight, names_nothing_while_all_is_well) {
    NightOptions options;
    options.seed = 12;
    options.camera = {400, 225};
    options.length = 45;
    const NightResult night = playNight(options);
    EXPECT_THAT(causesOf(night), IsEmpty());
    EXPECT_FALSE(night.drifts.empty());
}

// A projector is pushed, and its picture comes back.
NightOptions nightWithPush() {
    NightOptions options;
    options.seed = 5;
    options.outputs = 2;
    options.camera = {400, 225};
    options.geometry = "automatic";
    options.fault = "bump";
    options.faultAt = 4;
    options.length = 20;
    return options;
}

void expectBroughtBack(const NightResult& night, const std::string& what) {
    double moved = 0, most = 0;
    for (const Placed& placed : night.placed) {
        moved = std::max(moved, placed.moved);
        most = std::max(most, placed.shifted);
    }
    ASSERT_GT(moved, 3) << "a test of nothing";
    EXPECT_LT(most, 1.1 * moved) << what;
    EXPECT_LT(night.placed.back().missed, 1) << what;
    for (const auto& [output, far] : night.farthest) {
        if (output != night.output) {
            EXPECT_EQ(far, 0) << what;
        }
    }
}

// The camera's delay is no part of the loop, because the prediction knows what was shown. Example
// failure: it does not, and the correction goes too far by what was corrected meanwhile.
TEST(DrawnNight, brings_a_picture_back_without_overshoot_however_late_the_camera_is) {
    for (const double latency : {0.0, 0.25, 0.5}) {
        NightOptions options = nightWithPush();
        options.latency = latency;
        expectBroughtBack(playNight(options), std::to_string(latency));
    }
}

// Example failure: a picture whose frame is still under way is dropped, so nothing is ever seen.
TEST(DrawnNight, brings_a_picture_back_however_late_the_frames_are) {
    NightOptions options = nightWithPush();
    options.latency = 0.02;
    options.frameDelay = 0.27;
    expectBroughtBack(playNight(options), "");
}

// Example failure: a slow camera's pictures of the last second are too few to say anything.
TEST(DrawnNight, brings_a_picture_back_however_slow_the_camera_is) {
    for (const double rate : {1.0, 2.0}) {
        NightOptions options = nightWithPush();
        options.cameraRate = rate;
        options.faultAt = 6;
        expectBroughtBack(playNight(options), std::to_string(rate));
    }
}

// Example failure: nothing is predicted for such a camera, and nobody is told.
TEST(DrawnNight, says_that_the_camera_is_too_slow) {
    NightOptions options = nightWithPush();
    options.cameraRate = 0.4;
    const NightResult night = playNight(options);
    EXPECT_THAT(causesOf(night), ElementsAre("camera slow"));
    EXPECT_THAT(night.told, testing::HasSubstr("one picture in 2.5 s"));
}

// Example failure: the machine is busy, and the watch takes its own absence for the camera's.
TEST(DrawnNight, names_no_cause_after_it_stood_still_itself) {
    NightOptions options;
    options.seed = 12;
    options.outputs = 1;
    options.camera = {400, 225};
    options.standsStillAt = 8;
    options.length = 16;
    const NightResult night = playNight(options);
    EXPECT_THAT(causesOf(night), IsEmpty());
    ASSERT_FALSE(night.drifts.at(night.outputs[0]).empty());
    EXPECT_GT(seconds(night.drifts.at(night.outputs[0]).back().at), 13) << "it goes on";
}

// A night with a flood and a street lamp that may be trimmed.
NightOptions nightWithLamps(std::uint64_t seed) {
    NightOptions options;
    options.seed = seed;
    options.outputs = 2;
    options.camera = {400, 225};
    options.lamps = "automatic";
    return options;
}

// The least share of what the cue asked that the flood was given within a time.
double leastShare(const NightResult& night, double from, double to) {
    double least = 1;
    for (const LampMoment& moment : night.lamps)
        if (seconds(moment.at) >= from && seconds(moment.at) < to && moment.asked > 0)
            least = std::min(least, moment.given / moment.asked);
    return least;
}

// A window lights up, and is dark again: cues change the lamps meanwhile.
TEST(DrawnNight, lets_the_lamps_give_less_while_there_is_more_ambient_light) {
    for (const double latency : {0.0, 0.5}) {
        NightOptions options = nightWithLamps(4);
        options.latency = latency;
        options.script = {"kind: ambient, at: 20, until: 75, level: 12, rise: 0.5"};
        options.length = 115;
        const NightResult night = playNight(options);
        EXPECT_EQ(leastShare(night, 0, 22), 1) << latency;
        EXPECT_LT(leastShare(night, 22, 74), 0.9) << latency << night.told;
        EXPECT_GE(leastShare(night, 0, 200), 0.3 - 1e-6) << latency;
        for (const LampReport& report : night.otherLight) {
            if (seconds(report.at) > 58 && seconds(report.at) < 72) {  // a cue raises the spot then
                EXPECT_NEAR(report.excess, 0, 0.015) << latency << ": " << seconds(report.at) << " s\n" << night.told;
                EXPECT_GT(report.ambient, 0.01) << latency << ": " << seconds(report.at) << " s";
            }
        }
        EXPECT_EQ(leastShare(night, 112, 115), 1) << latency << night.told;
        EXPECT_THAT(night.told, testing::HasSubstr("c takes it back")) << latency;
        EXPECT_THAT(night.told, testing::HasSubstr("the lamps go back")) << latency;
    }
}

TEST(DrawnNight, lets_cues_people_headlights_and_fog_move_no_lamp) {
    NightOptions options = nightWithLamps(6);
    options.isBusy = true;
    options.script = {"kind: fog, at: 22, until: 40, density: 0.03, rise: 4",
                      "kind: cover, at: 48, until: 56, rectangle: [0, 0, 0.5, 1]",
                      "kind: exposure, at: 64, until: 74, gain: 0.5, rise: 2"};
    options.length = 85;
    const NightResult night = playNight(options);
    EXPECT_EQ(leastShare(night, 0, 200), 1) << night.told;
    EXPECT_FALSE(night.otherLight.empty());
    EXPECT_THAT(causesOf(night), testing::Contains("fog")) << "a test of nothing";
    for (const LampMoment& moment : night.lamps) ASSERT_TRUE(moment.isLampOn) << seconds(moment.at);
}

TEST(DrawnNight, only_advises_where_the_site_says_so) {
    NightOptions options = nightWithLamps(4);
    options.lamps = "advise";
    options.script = {"kind: ambient, at: 20, level: 12, rise: 1"};
    options.length = 40;
    const NightResult night = playNight(options);
    EXPECT_EQ(leastShare(night, 0, 200), 1);
    EXPECT_THAT(night.told, testing::HasSubstr("the lamps could give less"));
    EXPECT_GT(night.otherLight.back().excess, 0.01);
}

}  // namespace
}  // namespace fantascope::app
