#include "theatre/search/troupe.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace fantascope::theatre {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kSquare = 1;  // a silhouette's area in squares of its height

Result<Troupe> of(std::optional<int> actors, std::optional<double> height, std::vector<double> statures = {1.75},
                  double area = kSquare) {
    return Troupe::of(area, actors, height, statures);
}
std::string refusal(std::optional<int> actors, std::optional<double> height, std::vector<double> statures = {1.75}) {
    const auto troupe = of(actors, height, std::move(statures));
    return troupe ? "none" : troupe.error().message();
}

TEST(Troupe, has_one_more_for_every_share_of_the_silhouette) {
    EXPECT_EQ(of({}, 1.0)->statures.size(), 2u);
    EXPECT_EQ(of({}, 2.0)->statures.size(), 7u);
    EXPECT_EQ(of({}, 2.0, {1.75}, 0.5)->statures.size(), 3u);
    EXPECT_EQ(of({}, 0.5)->statures.size(), 1u);
    EXPECT_EQ(of({}, 6.0)->statures.size(), 12u);
    EXPECT_GT(of({}, 2.0, {1.2})->statures.size(), 10u) << "children have smaller shadows";
}

TEST(Troupe, plays_as_large_as_its_people_suffice_for) {
    EXPECT_DOUBLE_EQ(of(3, {})->height, std::round(100 * std::sqrt(1.8)) / 100);
    EXPECT_THAT(of(3, {})->statures, ElementsAre(1.75, 1.75, 1.75));
    EXPECT_DOUBLE_EQ(of(2, {}, {1.75}, 0.3)->height, 2);
    EXPECT_LT(of(3, {}, {1.2})->height, 1);
    EXPECT_EQ(of({}, {})->height, Troupe::kUsualHeight);
    EXPECT_EQ(of({}, {})->statures.size(), 5u);
}

TEST(Troupe, takes_what_is_said) {
    const auto given = of(4, 1.5);
    ASSERT_TRUE(given);
    EXPECT_EQ(given->height, 1.5);
    EXPECT_EQ(given->statures.size(), 4u);
    const auto each = of({}, {}, {1.5, 1.8});
    ASSERT_TRUE(each);
    EXPECT_THAT(each->statures, ElementsAre(1.5, 1.8));
}

// Each with what to do about it.
TEST(Troupe, refuses_what_cannot_be_played) {
    for (const int actors : {-1, 0, 50}) EXPECT_THAT(refusal(actors, {}), AllOf(HasSubstr("1 .. 49"), HasSubstr("'auto'")));
    EXPECT_EQ(refusal(49, {}), "none");
    for (const double height : {0.0, 0.2, 8.5, std::nan("")}) EXPECT_THAT(refusal(3, height), HasSubstr("0.3 .. 8 metres"));
    EXPECT_THAT(refusal(3, {}, {1.5, 1.8}), HasSubstr("2 are given for 3 actors"));
    EXPECT_THAT(refusal(1, 5), AllOf(HasSubstr("25.00 square metres at a height of 5 m, too large for 1 actor"),
                                     HasSubstr("take --height 0.35 .. 2.44, or --actors 5 .. 49")));
    EXPECT_THAT(refusal(20, 1),
                AllOf(HasSubstr("too small for 20 actors"), HasSubstr("--height 1.55 .. 8.00, or --actors 1 .. 8")));
}

// What the refusal advises is taken.
TEST(Troupe, takes_its_own_advice) {
    EXPECT_TRUE(of(1, 0.35));
    EXPECT_TRUE(of(1, 2.44));
    EXPECT_TRUE(of(5, 5.0));
    EXPECT_FALSE(of(4, 5.0));
    EXPECT_TRUE(of(8, 1.0));
    EXPECT_FALSE(of(9, 1.0));
}

// A silhouette on a screen on which shadows are twice as large wants four times the area. The easy
// wrong version adds up the pixels.
TEST(Troupe, fills_what_the_beams_want_on_average) {
    GreyImage picture(120, 120);
    for (int y = 10; y < 110; ++y)
        for (int x = 20; x < 70; ++x) picture.at(x, y) = 1;
    const PoseTarget target = PoseTarget::from(picture, {}, 1, 512).value();
    Stage stage;
    EXPECT_NEAR(areaToFill(std::vector{target}, stage), 0.5, 1e-3);
    stage.screens.push_back({{2.5, 1.5}, -std::numbers::pi / 2});
    stage.beams.push_back({{-4, 0, 1.5}, 1});
    const double scale = TargetPlace::on(stage, 1).scale;
    ASSERT_GT(scale, 1.1);
    EXPECT_NEAR(areaToFill(std::vector{target, target}, stage), 0.5 * (1 + scale * scale) / 2, 1e-3);
}

TEST(Troupe, is_as_high_on_every_screen) {
    Stage stage;
    EXPECT_EQ(targetOn(stage, 0, 1.234).height, 1.234);
    EXPECT_FALSE(targetOn(stage, 0, 1.234).middle);
    stage.screens.push_back({{2.5, 1.5}, -std::numbers::pi / 2});
    stage.beams.push_back({{-4, 0, 1.5}, 1});
    const TargetPlace place = TargetPlace::on(stage, 1);
    const Cast::Target target = targetOn(stage, 1, 1.2);
    EXPECT_NEAR(target.height, 1.2 * place.scale, 0.005);
    EXPECT_EQ(target.height, std::round(100 * target.height) / 100) << "whole centimetres";
    EXPECT_NEAR(target.middle.value(), place.middle.value(), 0.005);
    EXPECT_EQ(targetOn(stage, 1, 8).height, Troupe::kMostHeight);
}

}  // namespace
}  // namespace fantascope::theatre
