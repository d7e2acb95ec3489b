#include "theatre/search/troupe.h"

#include <gmock/gmock.h>

#include <cmath>

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

}  // namespace
}  // namespace fantascope::theatre
