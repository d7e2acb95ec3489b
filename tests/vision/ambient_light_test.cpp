// Ambient light is told from the light of lamps whose levels are known.

#include "vision/watch/ambient_light.h"

#include "core/random.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

namespace fantascope::vision {
namespace {

constexpr double kBase = 0.02;  // of full light

// A picture with two lamps and noise, measured every 0.8 s.
struct Wall {
    std::array<double, 2> strengths{0.08, 0.03};  // the lamps' light at full level
    double power = 1;                             // light = level ^ power
    double ambient = 0;
    std::vector<float> asked{1, 0};
    float share = 1;  // that a trim leaves of the first lamp
    AmbientLight light{2};
    Time now{};
    Rng rng{7};
    double most = 0, least = 0;  // of the rise that was estimated
    int strange = 0;             // measurements that did not count

    void see(double seconds) {
        for (double passed = 0; passed < seconds; passed += 0.8) {
            now += std::chrono::milliseconds(800);
            const std::vector<float> given{asked[0] * share, asked[1]};
            double seen = kBase + ambient + 0.0015 * (2 * rng.uniform() - 1);
            for (std::size_t i = 0; i < given.size(); ++i) seen += strengths[i] * std::pow(given[i], power);
            strange += light.see(seen, given, asked, now) ? 0 : 1;
            most = std::max(most, light.rise().mean);
            least = std::min(least, light.rise().mean);
        }
    }
};

TEST(AmbientLight, is_not_what_a_cue_changes_and_the_lamps_light_is_learned_from_that) {
    Wall wall;
    wall.see(10);
    for (const auto& [first, second] : {std::pair{0.3f, 0.0f}, {0.3f, 1.0f}, {1.0f, 0.5f}, {0.0f, 0.0f}, {1.0f, 0.0f}}) {
        wall.asked = {first, second};
        wall.see(8);
    }
    EXPECT_LT(wall.most, 0.003);
    EXPECT_GT(wall.least, -0.003);
    EXPECT_NEAR(wall.light.of(std::array{1.0f, 0.0f}).mean, 0.08, 0.004);
    EXPECT_NEAR(wall.light.of(std::array{0.0f, 1.0f}).mean, 0.03, 0.004);
    EXPECT_LT(wall.light.of(std::array{1.0f, 0.0f}).sigma, 0.01);
}

// Dimmers whose light is the square of the level.
TEST(AmbientLight, is_not_what_a_cue_changes_where_light_does_not_follow_the_level) {
    Wall wall;
    wall.power = 2;
    wall.see(10);
    for (const float level : {0.3f, 0.6f, 0.0f, 1.0f, 0.2f, 0.9f}) {
        wall.asked = {level, 0};
        wall.see(8);
    }
    EXPECT_LT(wall.most, 0.004);
    EXPECT_GT(wall.least, -0.004);
}

// Example failure: a car's headlights dim the lamps.
TEST(AmbientLight, counts_once_it_has_lasted) {
    Wall wall;
    wall.see(10);
    wall.ambient = 0.05;
    wall.see(4);
    EXPECT_LT(wall.most, 0.003);
    EXPECT_GT(wall.strange, 3);
    wall.ambient = 0;
    wall.see(10);
    EXPECT_LT(wall.most, 0.003) << "it was over before it counted";
    wall.ambient = 0.05;
    wall.see(10);
    EXPECT_NEAR(wall.light.rise().mean, 0.05, 0.003);
}

TEST(AmbientLight, that_rises_slowly_is_followed_at_once) {
    Wall wall;
    wall.see(10);
    for (int i = 0; i < 120; ++i) {
        wall.ambient = 0.0005 * i;
        wall.see(0.8);
    }
    EXPECT_NEAR(wall.light.rise().mean, 0.06, 0.008);
}

// Example failure: a cue brings another level, and what is ambient becomes usual.
TEST(AmbientLight, stays_through_cues_and_is_not_what_a_trim_takes_away) {
    Wall wall;
    wall.see(10);
    wall.ambient = 0.05;
    wall.see(12);
    for (int i = 0; i < 25; ++i) {
        wall.share -= 0.02f;
        wall.see(0.8);
    }
    EXPECT_NEAR(wall.light.rise().mean, 0.05, 0.005);
    EXPECT_NEAR(wall.light.of(std::array{1.0f, 0.0f}).mean, 0.08, 0.008) << "learned from the trim";
    wall.asked = {0.4f, 1};
    wall.see(8);
    wall.asked = {1, 0};
    wall.see(8);
    EXPECT_NEAR(wall.light.rise().mean, 0.05, 0.006);
    wall.ambient = 0;
    wall.see(12);
    EXPECT_NEAR(wall.light.rise().mean, 0, 0.006);
}

// Example failure: the cue's lamps are learned as brighter than they are, and the rise is
// forgotten.
TEST(AmbientLight, that_rises_just_before_a_cue_is_still_a_rise) {
    Wall wall;
    wall.asked = {0.6f, 0};
    wall.see(10);
    wall.asked = {1, 0};
    wall.see(10);
    wall.asked = {0.6f, 0};
    wall.see(10);
    wall.ambient = 0.04;
    wall.see(3);
    wall.asked = {1, 0};
    wall.see(8);
    EXPECT_NEAR(wall.light.rise().mean, 0.04, 0.01);
}

// Where lamps are known from cues. Example failure: what was strange for a second only when the cue
// came is forgotten, and becomes usual.
TEST(AmbientLight, that_comes_and_goes_at_any_time_before_a_cue_is_told_from_it) {
    for (const double power : {1.0, 2.0})
        for (int lead = 1; lead <= 10; ++lead) {  // measurements
            Wall wall;
            wall.power = power;
            wall.see(10);
            for (const float level : {0.6f, 1.0f, 0.6f}) {
                wall.asked = {level, 0};
                wall.see(8);
            }
            wall.ambient = 0.05;
            wall.see(0.8 * lead);
            wall.asked = {1, 0};
            wall.see(16);
            EXPECT_NEAR(wall.light.rise().mean, 0.05, 0.013) << lead << " measurements before, level ^ " << power;
            wall.ambient = 0;
            wall.see(0.8 * lead);
            wall.asked = {0.6f, 0};
            wall.see(16);
            EXPECT_NEAR(wall.light.rise().mean, 0, 0.013) << lead << " measurements before, level ^ " << power;
        }
}

TEST(AmbientLight, is_what_it_was_where_lamps_change_in_a_way_that_nobody_knows) {
    Wall wall;
    wall.see(10);
    wall.strengths[0] = 0.02;  // a moving head turned away
    wall.light.forgetBase();
    wall.see(10);
    EXPECT_NEAR(wall.light.rise().mean, 0, 0.003);
    EXPECT_EQ(wall.strange, 0);
}

}  // namespace
}  // namespace fantascope::vision
