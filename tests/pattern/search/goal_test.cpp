#include "pattern/search/goal.h"

#include "pattern/search/paper_method.h"

#include <gtest/gtest.h>

namespace fantascope::pattern {
namespace {

constexpr double kExact = 1e-12;  // for a few sums of integers, divided once

// A guide of 4 x 2 pixels, and a pattern that covers the left half of its upper row.
GreyImage smallGuide() {
    GreyImage guide(4, 2);
    const float stored[] = {1.0f, 0.2f, 0.6f, 0.0f,  //
                            0.4f, 0.4f, 0.0f, 0.8f};
    std::copy(std::begin(stored), std::end(stored), guide.pixels().begin());
    return guide;
}

Coverage leftOfTheUpperRow() {
    Coverage coverage(4, 2);
    const TriangleMesh square{{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
    coverage.add(Silhouette(square), {{0, -0.5}, 1, {}});  // x -2..2 pixels, y -3..1
    return coverage;
}

// z by hand: |1 - 1| + |.2 - 1| + .6 + 0 + .4 + .4 + 0 + .8 = 3, of 8 pixels.
TEST(Goal, is_the_mean_difference_of_guide_and_pattern) {
    EXPECT_NEAR(Goal(smallGuide()).z(leftOfTheUpperRow()), 3.0 / 8, kExact);
    EXPECT_NEAR(Goal(smallGuide()).z(Coverage(4, 2)), 3.4 / 8, kExact);
    EXPECT_NEAR(Goal(smallGuide()).mean(), 3.4 / 8, kExact);
}

// By hand: covering exactly 1, .6 and .8 leaves 0, .2, .4, 0, .4, .4, 0, .2.
TEST(Goal, bound_is_the_cost_of_the_guide_cut_at_a_half) { EXPECT_NEAR(Goal(smallGuide()).bound(), 1.6 / 8, kExact); }

// On a surface that gives white half, all, none and twice of its light. By hand, row by row: |1 -
// .5|, |.2 - 1|, .6, 0; .4, .4, 0, .8.
TEST(Goal, on_a_surface_is_that_of_what_is_seen) {
    GreyImage surface(4, 2);
    const float light[] = {0.5f, 1, 0, 2, 0.5f, 1, 0, 2};
    std::copy(std::begin(light), std::end(light), surface.pixels().begin());
    const Goal goal(smallGuide(), &surface);
    EXPECT_NEAR(goal.z(leftOfTheUpperRow()), 3.5 / 8, 1e-5);
    EXPECT_NEAR(goal.z(Coverage(4, 2)), 3.4 / 8, kExact) << "black is black everywhere";
    EXPECT_NEAR(goal.mean(), 3.4 / 8, kExact);
    // Covering pays where the light is: 1 by .5, .4 by .4 - .1 at half light; nothing else does.
    EXPECT_NEAR(goal.bound(), (3.4 - 0.5 - 0.3 - 0) / 8, 1e-5);
    // 1 and .6 cannot be reached, and are covered whole; .2, .4 / .5, .4, .8 / 2.
    EXPECT_NEAR(goal.wantedCoverage(), (1 + 0.2 + 1 + 0.8 + 0.4 + 0.4) / 8, 1e-5);
}

TEST(Goal, is_one_for_the_negative_and_zero_for_the_drawing_itself) {
    Coverage everything(70, 50);
    const TriangleMesh square{{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
    everything.add(Silhouette(square), {{0.5, 0.5}, 5, {}});
    EXPECT_EQ(Goal(GreyImage(70, 50, 1.0f)).z(everything), 0);
    EXPECT_EQ(Goal(GreyImage(70, 50, 0.0f)).z(everything), 1);
}

// g_i = mean of I - I'. By hand: the left 2 x 2 holds 1 - 1, .2 - 1, .4, .4; the right .6, 0, 0,
// .8.
TEST(Goal, difference_index_is_the_mean_difference_of_a_cell_with_its_sign) {
    const Goal goal(smallGuide());
    const Coverage pattern = leftOfTheUpperRow();
    EXPECT_NEAR(goal.differenceIndex({{0, 0}, {2, 2}}, pattern), 0, kExact);
    EXPECT_NEAR(goal.differenceIndex({{0, 0}, {2, 1}}, pattern), -0.4, kExact);  // covers too much
    EXPECT_NEAR(goal.differenceIndex({{2, 0}, {4, 2}}, pattern), 0.35, kExact);  // wants more
    EXPECT_NEAR(goal.differenceIndex({{1, 0}, {2, 1}}, pattern), -0.8, kExact);
}

// p_cre = (g - l) / (1 - l), by hand: (.55 - .1) / .9 = .5; nothing at the threshold, certainty at
// g = 1.
TEST(Goal, create_probability_rises_from_the_threshold_to_one) {
    EXPECT_NEAR(createProbability(0.55, 0.1), 0.5, kExact);
    EXPECT_EQ(createProbability(0.1, 0.1), 0);
    EXPECT_EQ(createProbability(-0.7, 0.1), 0);
    EXPECT_EQ(createProbability(1, 0.3), 1);
}

// p_del = (g - l) / (-1 - l), by hand: (-.6 + .2) / -.8 = .5.
TEST(Goal, delete_probability_rises_from_the_threshold_to_one) {
    EXPECT_NEAR(deleteProbability(-0.6, -0.2), 0.5, kExact);
    EXPECT_EQ(deleteProbability(-0.2, -0.2), 0);
    EXPECT_EQ(deleteProbability(0.7, -0.2), 0);
    EXPECT_EQ(deleteProbability(-1, -0.3), 1);
}

}  // namespace
}  // namespace fantascope::pattern
