#include "pattern/shape/grouping.h"

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

namespace fantascope::pattern {
namespace {

using testing::Each;

// `count` points within `radius` of each place.
std::vector<glm::dvec2> around(const std::vector<glm::dvec2>& places, int count, double radius) {
    Rng rng(9);
    std::vector<glm::dvec2> points;
    for (const glm::dvec2& place : places)
        for (int i = 0; i < count; ++i)
            points.push_back(place + glm::dvec2(rng.uniform(-radius, radius), rng.uniform(-radius, radius)));
    return points;
}

FuzzyClusters clustered(const std::vector<glm::dvec2>& points, const FuzzyClusters::Options& options, std::uint64_t seed = 1) {
    Rng rng(seed);
    return fuzzyCMeans(points, options, rng);
}

void expectRowsSumToOne(const FuzzyClusters& clusters) {
    const std::size_t points = clusters.memberships.size() / clusters.centres.size();
    for (std::size_t i = 0; i < points; ++i) {
        const auto row = clusters.membershipsOf(i);
        EXPECT_NEAR(std::accumulate(row.begin(), row.end(), 0.0), 1.0, 1e-12) << "point " << i;
        for (const double membership : row) EXPECT_TRUE(membership >= 0 && membership <= 1) << membership;
    }
}

const std::vector<glm::dvec2> kPlaces{{0.2, 0.2}, {1.5, 0.3}, {0.9, 0.9}};

// This holds for any start. Example failure: with first centres drawn uniformly, two of them fall
// into one cluster and another gets none.
TEST(FuzzyCMeans, finds_clusters_that_lie_apart) {
    std::vector<glm::dvec2> places;
    for (int i = 0; i < 12; ++i) places.emplace_back(0.4 * (i % 4), 0.4 * (i / 4));
    const auto points = around(places, 10, 0.02);
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        const auto clusters = clustered(points, {.clusters = 12, .fuzziness = 1.5}, seed);
        EXPECT_EQ(clusters.summary.reason, FuzzyClusters::StopReason::Converged);
        expectRowsSumToOne(clusters);
        for (std::size_t i = 0; i < points.size(); ++i) {
            const auto row = clusters.membershipsOf(i);
            const auto own = static_cast<std::size_t>(std::max_element(row.begin(), row.end()) - row.begin());
            ASSERT_GT(row[own], 0.9) << "seed " << seed;
            ASSERT_LT(glm::length(clusters.centres[own] - places[i / 10]), 0.02) << "seed " << seed;
        }
    }
}

TEST(FuzzyCMeans, never_lets_its_objective_rise) {
    const auto points = around({{0.5, 0.5}}, 200, 0.5);
    for (const double fuzziness : {1.1, 1.5, 2.0, 3.0}) {
        const auto objective = clustered(points, {.clusters = 8, .fuzziness = fuzziness}).summary.objective;
        ASSERT_GT(objective.size(), 3u);
        EXPECT_LT(objective.back(), 0.95 * objective.front());
        for (std::size_t i = 1; i < objective.size(); ++i)
            EXPECT_LE(objective[i], objective[i - 1] * (1 + 1e-12)) << "m " << fuzziness;
    }
}

// Bezdek's fixed point: each membership follows from the ratios of distances, each centre is the
// mean weighted by membership^m.
TEST(FuzzyCMeans, ends_where_memberships_and_centres_agree) {
    const auto points = around({{0.5, 0.5}}, 60, 0.5);
    const double m = 1.7;
    const auto clusters = clustered(points, {.clusters = 4, .fuzziness = m, .tolerance = 1e-12, .maxIterations = 5000});
    ASSERT_EQ(clusters.summary.reason, FuzzyClusters::StopReason::Converged);
    for (std::size_t k = 0; k < 4; ++k) {
        glm::dvec2 sum(0);
        double weights = 0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            const double distance = glm::length(points[i] - clusters.centres[k]);
            double ratios = 0;
            for (const glm::dvec2& other : clusters.centres)
                ratios += std::pow(distance / glm::length(points[i] - other), 2 / (m - 1));
            const double membership = clusters.membershipsOf(i)[k];
            EXPECT_NEAR(membership, 1 / ratios, 1e-10);
            sum += std::pow(membership, m) * points[i];
            weights += std::pow(membership, m);
        }
        EXPECT_LT(glm::length(sum / weights - clusters.centres[k]), 1e-10);
    }
}

// A small m is nearly k-means, a large one makes memberships nearly equal. No power overflows.
TEST(FuzzyCMeans, blurs_its_clusters_with_m) {
    const auto points = around(kPlaces, 30, 0.2);
    double sharpestBefore = 2;
    for (const double fuzziness : {1.0001, 1.5, 2.0, 5.0}) {
        const auto clusters = clustered(points, {.clusters = 3, .fuzziness = fuzziness});
        expectRowsSumToOne(clusters);
        double sharpest = 0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            const auto row = clusters.membershipsOf(i);
            sharpest += *std::max_element(row.begin(), row.end()) / static_cast<double>(points.size());
        }
        EXPECT_LT(sharpest, sharpestBefore) << "m " << fuzziness;
        sharpestBefore = sharpest;
        if (fuzziness < 1.01) {
            EXPECT_GT(sharpest, 0.99);
        }
    }
}

// Example failure: a distance of zero divides, and every number turns into NaN.
TEST(FuzzyCMeans, gives_a_point_on_a_centre_to_that_centre_alone) {
    // The mean of these coordinates is exact, so that the final centres coincide with their points.
    std::vector<glm::dvec2> points(16, {0.125, 0.25});
    points.insert(points.end(), 16, {0.875, 0.5});
    const auto clusters = clustered(points, {.clusters = 2, .fuzziness = 2});
    expectRowsSumToOne(clusters);
    for (std::size_t i = 0; i < points.size(); ++i)
        EXPECT_THAT(clusters.membershipsOf(i), testing::Contains(1.0)) << "point " << i;
    EXPECT_EQ(clusters.summary.objective.back(), 0);
}

// Nearly sharp clusters can lose their last point to their neighbours, here for some of the starts.
// A centre without any weight stays where it is. Example failure: 0 / 0.
TEST(FuzzyCMeans, keeps_a_centre_to_which_nothing_belongs) {
    const std::vector<glm::dvec2> points{{7, 6}, {6, 5}, {5, 0}, {10, 0}, {6, 1}, {8, 5}, {7, 6}};
    for (std::uint64_t seed = 1; seed <= 200; ++seed)
        for (const glm::dvec2& centre : clustered(points, {.clusters = 3, .fuzziness = 1.0002}, seed).centres)
            ASSERT_TRUE(std::isfinite(centre.x) && std::isfinite(centre.y)) << "seed " << seed;
}

TEST(FuzzyCMeans, puts_everything_into_one_cluster_if_there_is_one) {
    const auto points = around(kPlaces, 10, 0.1);
    const auto clusters = clustered(points, {.clusters = 1, .fuzziness = 1.5});
    EXPECT_THAT(clusters.memberships, Each(1.0));
    const glm::dvec2 mean = std::accumulate(points.begin(), points.end(), glm::dvec2(0)) / static_cast<double>(points.size());
    EXPECT_LT(glm::length(clusters.centres[0] - mean), 1e-12);
}

TEST(FuzzyCMeans, copes_with_fewer_points_than_clusters) {
    for (const double fuzziness : {1.05, 1.5, 2.0}) {
        const auto clusters = clustered({{0.2, 0.3}, {0.8, 0.4}}, {.clusters = 5, .fuzziness = fuzziness});
        expectRowsSumToOne(clusters);
        for (const glm::dvec2& centre : clusters.centres) EXPECT_TRUE(std::isfinite(centre.x) && std::isfinite(centre.y));
    }
}

TEST(FuzzyCMeans, says_that_it_ran_out_of_iterations) {
    const auto clusters = clustered(around(kPlaces, 30, 0.3), {.clusters = 3, .maxIterations = 2});
    EXPECT_EQ(clusters.summary.reason, FuzzyClusters::StopReason::IterationLimit);
    EXPECT_EQ(clusters.summary.objective.size(), 2u);
}

TEST(FuzzyCMeans, depends_on_the_seed_alone) {
    const auto points = around({{0.5, 0.5}}, 100, 0.5);
    EXPECT_EQ(clustered(points, {.clusters = 6}, 3).memberships, clustered(points, {.clusters = 6}, 3).memberships);
    EXPECT_NE(clustered(points, {.clusters = 6}, 3).memberships, clustered(points, {.clusters = 6}, 4).memberships);
}

// "Choosing the first group that has a greater accumulated probability than the random number":
// shares follow the memberships.
TEST(DrawGroup, follows_the_memberships) {
    const std::vector<double> memberships{0.5, 0.0, 0.2, 0.3};
    constexpr std::uint32_t kIds = 20'000;
    std::vector<double> share(4, 0.0);
    for (std::uint32_t id = 0; id < kIds; ++id) share[drawGroup(memberships, 77, id)] += 1.0 / kIds;
    // Five standard deviations of a share of 0.5 among kIds draws.
    const double bound = 5 * std::sqrt(0.25 / kIds);
    for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(share[k], memberships[k], bound) << "group " << k;
    EXPECT_EQ(share[1], 0);
}

TEST(DrawGroup, takes_the_only_group_that_a_sure_membership_names) {
    for (std::uint32_t id = 0; id < 100; ++id) EXPECT_EQ(drawGroup(std::vector<double>{0, 0, 1, 0}, 1, id), 2u);
}

TEST(GroupCount, is_the_nearest_whole_number_and_at_least_one) {
    EXPECT_EQ(groupCount(0, 20), 1u);
    EXPECT_EQ(groupCount(9, 20), 1u);
    EXPECT_EQ(groupCount(29, 20), 1u);
    EXPECT_EQ(groupCount(30, 20), 2u);
    EXPECT_EQ(groupCount(350, 20), 18u);
    EXPECT_EQ(groupCount(3, 0.5), 6u);
}

ShapePattern patternAt(const std::vector<glm::dvec2>& centres) {
    ShapePattern pattern;
    pattern.seed = 21;
    for (const glm::dvec2& centre : centres) {
        ShapeInstance instance;
        instance.id = static_cast<std::uint32_t>(pattern.instances.size());
        instance.centre = centre;
        pattern.instances.push_back(instance);
    }
    return pattern;
}

TEST(AssignGroups, makes_a_group_of_what_lies_together) {
    ShapePattern pattern = patternAt(around(kPlaces, 20, 0.03));
    pattern.motion.fuzziness = 1.2;
    const auto summary = assignGroups(pattern);
    EXPECT_EQ(summary.reason, FuzzyClusters::StopReason::Converged);
    ASSERT_EQ(pattern.groups, 3u);
    std::set<std::uint32_t> seen;
    for (std::size_t i = 0; i < pattern.instances.size(); ++i) {
        EXPECT_EQ(pattern.instances[i].group, pattern.instances[i - i % 20].group) << "instance " << i;
        seen.insert(pattern.instances[i].group);
    }
    EXPECT_EQ(seen.size(), 3u);
}

// "The shape groups should overlap each other a little."
TEST(AssignGroups, lets_groups_overlap_a_little) {
    ShapePattern pattern = patternAt(around({{0.8, 0.5}}, 400, 0.5));
    assignGroups(pattern);
    ASSERT_EQ(pattern.groups, 20u);
    std::vector<glm::dvec2> sum(pattern.groups, glm::dvec2(0));
    std::vector<double> count(pattern.groups, 0.0);
    for (const ShapeInstance& instance : pattern.instances) sum[instance.group] += instance.centre, count[instance.group] += 1;
    int nearest = 0;
    for (const ShapeInstance& instance : pattern.instances) {
        const auto distance = [&](std::uint32_t group) { return glm::length(sum[group] / count[group] - instance.centre); };
        bool isNearest = true;
        for (std::uint32_t group = 0; group < pattern.groups; ++group)
            if (count[group] > 0 && distance(group) < distance(instance.group)) isNearest = false;
        nearest += isNearest;
    }
    EXPECT_GT(nearest, 400 * 60 / 100);
    EXPECT_LT(nearest, 400 * 95 / 100);
}

TEST(AssignGroups, leaves_an_empty_pattern_with_one_group) {
    ShapePattern pattern;
    pattern.groups = 9;
    assignGroups(pattern);
    EXPECT_EQ(pattern.groups, 1u);
}

}  // namespace
}  // namespace fantascope::pattern
