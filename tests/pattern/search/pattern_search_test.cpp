#include "pattern/search/pattern_search.h"

#include "pattern/search/measure.h"
#include "pattern/search_helpers.h"

#include "scratch_folder.h"

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace fantascope::pattern {
namespace {

using testing::HasSubstr;

// White in the left half, black in the right.
GreyImage halfWhite(int width = 96, int height = 54) {
    GreyImage guide(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width / 2; ++x) guide.at(x, y) = 1;
    return guide;
}

PatternSearch::Options fewInstances(int iterations) {
    PatternSearch::Options options;
    options.method = PatternSearch::Method::Paper;
    options.instances = 60;
    options.iterations = iterations;
    return options;
}

PatternSearch::Found search(const GreyImage& guide, const PatternSearch::Options& options, std::uint64_t seed = 1,
                            int threads = 1) {
    return PatternSearch::run(guide, withShapes({"triangle", "square"}, seed), options, threads, never);
}

std::string refusal(const PatternSearch::Options& options) {
    const auto checked = options.check();
    return checked ? "accepted" : checked.error().message();
}

TEST(PatternSearch, reads_as_the_drawing_after_a_few_hundred_iterations) {
    const auto found = search(halfWhite(), fewInstances(300));
    EXPECT_LT(found.summary.z, 0.06);  // the random start has about 0.5
    std::size_t inTheWhite = 0;
    for (const ShapeInstance& instance : found.pattern.instances)
        inTheWhite += instance.centre.x < 0.5 * found.pattern.aspect() ? 1 : 0;
    EXPECT_EQ(inTheWhite, found.pattern.instances.size());
}

// Only a better candidate replaces the reference solution. Example failure: the best candidate of
// an iteration always does.
TEST(PatternSearch, z_never_rises_and_an_iteration_is_accepted_when_its_best_is_better) {
    double reference = 2;
    std::vector<double> seen;
    const auto found = PatternSearch::run(halfWhite(), withShapes({"leaf"}), fewInstances(120), 1, [&](const auto& progress) {
        seen.push_back(progress.z);
        return std::optional<StopReason>();
    });
    ASSERT_EQ(seen.size(), 120u);
    ASSERT_EQ(found.summary.history.size(), 120u);
    int accepted = 0;
    for (std::size_t i = 0; i < seen.size(); ++i) {
        const PatternSearch::Iteration& iteration = found.summary.history[i];
        EXPECT_LE(seen[i], reference);
        reference = seen[i];
        EXPECT_LE(iteration.zMin, iteration.zMax);
        EXPECT_EQ(iteration.accepted, iteration.zMin < reference);
        const double next = i + 1 < seen.size() ? seen[i + 1] : found.summary.z;
        EXPECT_EQ(next, iteration.accepted ? iteration.zMin : reference);
        accepted += iteration.accepted ? 1 : 0;
    }
    EXPECT_GT(accepted, 20);
    EXPECT_LT(accepted, 120);
    EXPECT_EQ(found.summary.evaluations, 1 + 12 * 120);
}

// Example failure: every slot draws the same numbers, so that twelve candidates are as good as one.
TEST(PatternSearch, candidates_of_an_iteration_differ) {
    const auto history = search(halfWhite(), fewInstances(20)).summary.history;
    EXPECT_TRUE(
        std::all_of(history.begin(), history.end(), [](const auto& iteration) { return iteration.zMin < iteration.zMax; }));
}

// Example failure: candidates draw from one common stream, in the order in which threads happen to
// run.
TEST(PatternSearch, gives_the_same_pattern_on_any_number_of_threads) {
    const auto one = search(halfWhite(), fewInstances(40), 7, 1);
    for (const int threads : {2, 5}) {
        const auto many = search(halfWhite(), fewInstances(40), 7, threads);
        EXPECT_TRUE(same(one.pattern.instances, many.pattern.instances)) << threads << " threads";
        EXPECT_EQ(one.summary.z, many.summary.z);
    }
    EXPECT_FALSE(same(one.pattern.instances, search(halfWhite(), fewInstances(40), 8).pattern.instances));
}

// A run that the caller stopped is repeated by its number of iterations.
TEST(PatternSearch, repeats_a_run_that_the_caller_stopped) {
    const auto stopped = PatternSearch::run(halfWhite(), withShapes({"triangle", "square"}), fewInstances(1000), 1,
                                            [](const PatternSearch::Progress& progress) -> std::optional<StopReason> {
                                                if (progress.iterations == 17) return StopReason::Time;
                                                return std::nullopt;
                                            });
    EXPECT_EQ(stopped.summary.reason, StopReason::Time);
    ASSERT_EQ(stopped.summary.iterations, 17);
    EXPECT_EQ(stopped.summary.history.size(), 17u);
    const auto repeated = search(halfWhite(), fewInstances(17));
    EXPECT_EQ(repeated.summary.reason, StopReason::Iterations);
    EXPECT_TRUE(same(stopped.pattern.instances, repeated.pattern.instances));
}

TEST(PatternSearch, stops_below_the_target_and_not_before) {
    PatternSearch::Options options = fewInstances(100000);
    options.targetZ = 0.2;
    const auto found = search(halfWhite(), options);
    EXPECT_EQ(found.summary.reason, StopReason::TargetReached);
    EXPECT_LT(found.summary.z, 0.2);
    const auto& history = found.summary.history;
    EXPECT_TRUE(std::all_of(history.begin(), history.end() - 1, [](const auto& iteration) { return iteration.zMin >= 0.2; }));
}

TEST(PatternSearch, without_an_iteration_is_the_random_start) {
    const auto found = search(halfWhite(), fewInstances(0));
    EXPECT_EQ(found.pattern.instances.size(), 30u);
    EXPECT_TRUE(found.summary.history.empty());
}

// With too much coverage everywhere, instances are deleted. A threshold that no cell reaches keeps
// them all.
TEST(PatternSearch, deletes_where_the_guide_is_dark_unless_the_threshold_forbids) {
    const GreyImage black(96, 54, 0.0f);
    PatternSearch::Options options = fewInstances(100);
    options.size = {0.05, 0.1};
    const auto emptied = search(black, options);
    EXPECT_EQ(emptied.pattern.instances.size(), 0u);
    EXPECT_EQ(emptied.summary.z, 0);

    options.paper.lambdaDelete = -0.999;
    EXPECT_EQ(search(black, options).pattern.instances.size(), 30u);
}

// With too little coverage everywhere, instances are created up to the maximum. A threshold that no
// cell reaches creates none.
TEST(PatternSearch, creates_where_the_guide_is_light_unless_the_threshold_forbids) {
    const GreyImage white(96, 54, 0.9f);
    PatternSearch::Options options = fewInstances(100);
    options.size = {0.03, 0.06};  // too small to fill the picture, so that there is always more to create
    EXPECT_EQ(search(white, options).pattern.instances.size(), 60u);

    options.paper.lambdaCreate = 0.95;
    const auto kept = search(white, options).pattern.instances;
    EXPECT_TRUE(std::all_of(kept.begin(), kept.end(), [](const ShapeInstance& instance) { return instance.id <= 30; }));
}

TEST(PatternSearch, grows_where_the_guide_is_light_and_shrinks_where_it_is_dark) {
    PatternSearch::Options options = fewInstances(150);
    options.paper.lambdaCreate = 0.999, options.paper.lambdaDelete = -0.999;  // only sizes change
    options.size = {0.01, 0.2};
    const auto meanSize = [](const PatternSearch::Found& found) {
        double sum = 0;
        for (const ShapeInstance& instance : found.pattern.instances) sum += instance.size;
        return sum / static_cast<double>(found.pattern.instances.size());
    };
    const double atFirst = meanSize(search(GreyImage(96, 54, 1.0f), [&] {
        auto o = options;
        o.iterations = 0;
        return o;
    }()));
    EXPECT_GT(meanSize(search(GreyImage(96, 54, 1.0f), options)), 1.2 * atFirst);
    EXPECT_LT(meanSize(search(GreyImage(96, 54, 0.0f), options)), 0.8 * atFirst);
}

TEST(PatternSearch, keeps_every_instance_within_the_settings) {
    PatternSearch::Options options = fewInstances(60);
    options.size = {0.03, 0.08};
    options.tilt = 0.3, options.turn = 0.5;
    options.paper.largestAmount = 3;  // wild
    options.colours = {{{0.1, 0.5, 0.2}, {0.3, 0.9, 0.4}}, {{0, 0, 1}, {0, 0, 1}}};
    const auto found = search(halfWhite(), options);
    std::set<std::uint32_t> ids;
    int blue = 0;
    constexpr double kStep = 1e-6;  // instances are rounded so that a file can hold them
    for (const ShapeInstance& i : found.pattern.instances) {
        EXPECT_TRUE(ids.insert(i.id).second) << "id " << i.id << " is given twice";
        EXPECT_LT(i.shape, 2u);
        EXPECT_LT(i.group, found.pattern.groups);
        EXPECT_TRUE(i.centre.x >= 0 && i.centre.x <= found.pattern.aspect() && i.centre.y >= 0 && i.centre.y <= 1);
        EXPECT_TRUE(i.size >= 0.03 - kStep && i.size <= 0.08 + kStep) << i.size;
        EXPECT_LE(std::max(std::abs(i.rotation.x), std::abs(i.rotation.y)), 0.3 + kStep);
        EXPECT_LE(std::abs(i.rotation.z), 0.5 + kStep);
        if (i.colour == glm::vec3(0, 0, 1))
            ++blue;
        else
            EXPECT_NEAR((i.colour.r - 0.1) / 0.2, (i.colour.g - 0.5) / 0.4, 2e-3) << "not between the two of its range";
    }
    EXPECT_GT(blue, 0);
    EXPECT_LT(blue, static_cast<int>(ids.size()));
}

// An instance's random colour comes from (seed, id). Example failure: colours are drawn in the
// order of the list, so that removing an instance recolours all that follow.
TEST(PatternSearch, gives_an_instance_the_same_colour_whatever_the_others_are) {
    PatternSearch::Options options = fewInstances(5);
    options.colours = {{{0, 0, 0}, {1, 1, 1}}};
    const auto few = search(halfWhite(), options);
    options.iterations = 30;
    const auto more = search(halfWhite(), options);
    ASSERT_NE(few.pattern.instances.size(), more.pattern.instances.size());
    int both = 0;
    for (const ShapeInstance& a : few.pattern.instances)
        for (const ShapeInstance& b : more.pattern.instances)
            if (a.id == b.id) {
                EXPECT_EQ(a.colour, b.colour);
                ++both;
            }
    EXPECT_GT(both, 5);
}

TEST(PatternSearch, resamples_a_guide_with_more_rows_than_asked) {
    PatternSearch::Options options = fewInstances(2);
    options.rows = 27;
    const auto found = search(halfWhite(96, 54), options);
    EXPECT_EQ(found.pattern.width, 48);
    EXPECT_EQ(found.pattern.height, 27);
    options.rows = 720;
    EXPECT_EQ(search(halfWhite(96, 54), options).pattern.height, 54);
}

// The written pattern is exactly the one that was compared. Example failure: z in the report is of
// unrounded instances.
TEST(PatternSearch, z_is_that_of_the_pattern_as_it_is_read_back) {
    GreyImage guide(97, 54);  // white up to the border, with an aspect that is no short decimal
    for (int y = 0; y < 54; ++y)
        for (int x = 80; x < 97; ++x) guide.at(x, y) = 1;
    auto found = search(guide, fewInstances(60));
    const ScratchFolder folder;
    found.pattern.guide = folder / "guide.png";
    const auto written = writePattern(folder / "p.pattern.yaml", found.pattern);
    ASSERT_TRUE(written) << written.error().message();
    const ShapePattern read = readPattern(folder / "p.pattern.yaml").value();
    EXPECT_TRUE(same(read.instances, found.pattern.instances));
    EXPECT_EQ(measure(read, guide).z, found.summary.z);
}

TEST(PatternSearch, options_that_break_a_rule_are_refused_with_name_value_and_rule) {
    EXPECT_EQ(refusal({}), "accepted");
    PatternSearch::Options options;
    options.paper.successRate = 1;
    EXPECT_EQ(refusal(options), "success_rate = 1 must be in 0.01 .. 0.99");
    options = {};
    options.instances = 0;
    EXPECT_THAT(refusal(options), HasSubstr("instances = 0"));
    options = {};
    options.size = {0.2, 0.1};
    EXPECT_THAT(refusal(options), HasSubstr("size = [0.2, 0.1] must be [smallest, largest]"));
    options = {};
    options.colours.clear();
    EXPECT_THAT(refusal(options), HasSubstr("colours"));
    options = {};
    options.tilt = NAN;
    EXPECT_THAT(refusal(options), HasSubstr("tilt"));
}

// -1 < delete <= reduce <= 0 <= increase <= create < 1 (section 4.1).
TEST(PatternSearch, thresholds_out_of_order_are_refused) {
    const auto thresholds = [](double remove, double reduce, double increase, double create) {
        PatternSearch::Options options;
        options.paper.lambdaDelete = remove, options.paper.lambdaReduce = reduce, options.paper.lambdaIncrease = increase,
        options.paper.lambdaCreate = create;
        return refusal(options);
    };
    EXPECT_EQ(thresholds(-0.5, -0.1, 0.1, 0.5), "accepted");
    EXPECT_EQ(thresholds(-0.5, -0.5, 0, 0), "accepted");
    const std::vector<std::array<double, 4>> broken = {{-1, -0.1, 0.1, 0.5},     {-0.1, -0.5, 0.1, 0.5}, {-0.5, 0.1, 0.2, 0.5},
                                                       {-0.5, -0.1, -0.05, 0.5}, {-0.5, -0.1, 0.5, 0.1}, {-0.5, -0.1, 0.1, 1}};
    for (const auto& [remove, reduce, increase, create] : broken)
        EXPECT_THAT(thresholds(remove, reduce, increase, create), HasSubstr("must hold")) << remove << " " << create;
}

}  // namespace
}  // namespace fantascope::pattern
