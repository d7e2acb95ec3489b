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

// The camera's delay is no part of the loop, because the prediction knows what was shown. Example
// failure: it does not, and the correction goes too far by what was corrected meanwhile.
TEST(DrawnNight, brings_a_picture_back_without_overshoot_however_late_the_camera_is) {
    for (const double latency : {0.0, 0.25, 0.5}) {
        NightOptions options;
        options.seed = 5;
        options.outputs = 2;
        options.camera = {400, 225};
        options.geometry = "automatic";
        options.latency = latency;
        options.fault = "bump";
        options.faultAt = 4;
        options.length = 20;
        const NightResult night = playNight(options);
        double moved = 0, most = 0;
        for (const Placed& placed : night.placed) {
            moved = std::max(moved, placed.moved);
            most = std::max(most, placed.shifted);
        }
        ASSERT_GT(moved, 3) << "a test of nothing";
        EXPECT_LT(most, 1.1 * moved) << latency;
        EXPECT_LT(night.placed.back().missed, 1) << latency;
        for (const auto& [output, far] : night.farthest) {
            if (output != night.output) {
                EXPECT_EQ(far, 0) << latency;
            }
        }
    }
}

}  // namespace
}  // namespace fantascope::app
