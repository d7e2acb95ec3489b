#include "theatre/search/solution_choice.h"

#include "core/random.h"

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <algorithm>
#include <limits>

namespace fantascope::theatre {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

using Solution = std::vector<PlacedActor>;

// Somebody of two joints, the second half a metre above the first.
PlacedActor at(double x, double stature = 1.75) { return {stature, {{x, 1, 2}, {x, 1.5, 2}}}; }

TEST(Difference, is_the_joints_mean_distance_in_metres) {
    EXPECT_DOUBLE_EQ(difference(Solution{at(0)}, Solution{at(0.3)}), 0.3);
    EXPECT_DOUBLE_EQ(difference(Solution{at(0), at(5)}, Solution{at(0.3), at(5)}), 0.15);
    Solution bent{at(0)};
    bent[0].joints[1] += glm::dvec3(0.3, 0, 0.4);
    EXPECT_DOUBLE_EQ(difference(Solution{at(0)}, bent), 0.25);
}

// Example failure: the same picture is shown twice because actors 1 and 3 have changed places.
TEST(Difference, is_none_where_people_of_one_stature_change_places) {
    EXPECT_EQ(difference(Solution{at(0), at(1), at(2)}, Solution{at(2), at(0), at(1)}), 0);
}

TEST(Difference, is_some_where_people_of_other_statures_change_places) {
    const Solution a{at(0, 1.6), at(1, 1.8), at(4, 1.8)};
    EXPECT_DOUBLE_EQ(difference(a, Solution{at(1, 1.6), at(0, 1.8), at(4, 1.8)}), 2.0 / 3);
    EXPECT_EQ(difference(a, Solution{at(4, 1.8), at(0, 1.6), at(1, 1.8)}), 0) << "in whatever order they are listed";
}

// Against all assignments, one by one.
TEST(Difference, is_that_of_the_best_assignment) {
    Rng rng(5);
    for (int trial = 0; trial < 50; ++trial) {
        Solution a, b;
        for (int i = 0; i < 5; ++i) {
            a.push_back({1.7, {{rng.uniform(), rng.uniform(), rng.uniform()}}});
            b.push_back({1.7, {{rng.uniform(), rng.uniform(), rng.uniform()}}});
        }
        std::vector<std::size_t> order{0, 1, 2, 3, 4};
        double least = std::numeric_limits<double>::infinity();
        do {
            double sum = 0;
            for (std::size_t i = 0; i < 5; ++i) sum += glm::distance(a[i].joints[0], b[order[i]].joints[0]);
            least = std::min(least, sum / 5);
        } while (std::next_permutation(order.begin(), order.end()));
        ASSERT_NEAR(difference(a, b), least, 1e-12) << trial;
        ASSERT_NEAR(difference(b, a), least, 1e-12) << trial;
    }
}

TEST(MostDifferent, begins_with_the_best_and_goes_on_with_the_farthest_from_all_chosen) {
    const std::vector<Solution> solutions{{at(0)}, {at(0.1)}, {at(3)}, {at(3.05)}, {at(1.6)}};
    EXPECT_THAT(mostDifferent(solutions, 3), ElementsAre(0, 3, 4));
    EXPECT_THAT(mostDifferent(solutions, 1), ElementsAre(0));
    EXPECT_THAT(mostDifferent(solutions, 9), ElementsAre(0, 3, 4, 1, 2));
    EXPECT_THAT(mostDifferent({}, 3), IsEmpty());
}

TEST(MostDifferent, takes_the_better_of_those_that_are_equally_far) {
    EXPECT_THAT(mostDifferent(std::vector<Solution>{{at(0)}, {at(1)}, {at(-1)}}, 2), ElementsAre(0, 1));
}

}  // namespace
}  // namespace fantascope::theatre
