#include "pattern/search/coverage.h"
#include "pattern/search/measure.h"
#include "pattern/search/running_score.h"
#include "pattern/search_helpers.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <set>
#include <utility>

namespace fantascope::pattern {
namespace {

// A ramp from black at the left to white at the right. Its width is not a multiple of a word.
GreyImage ramp(int width = 150, int height = 90) {
    GreyImage guide(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) guide.at(x, y) = static_cast<float>(x) / static_cast<float>(width - 1);
    return guide;
}

// Two white bars.
GreyImage bars(int width = 150, int height = 90) {
    GreyImage guide(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) guide.at(x, y) = x % 60 >= 20 && x % 60 < 50 ? 1.0f : 0.0f;
    return guide;
}

// Light from a fifth to one and a half, of another size than any guide.
std::shared_ptr<const GreyImage> stains() {
    GreyImage surface(90, 54);
    for (int y = 0; y < surface.height(); ++y)
        for (int x = 0; x < surface.width(); ++x)
            surface.at(x, y) = 0.85f + 0.65f * std::sin(0.11f * static_cast<float>(x)) * std::cos(0.09f * static_cast<float>(y));
    return std::make_shared<const GreyImage>(std::move(surface));
}

PatternSearch::Options refined(int iterations) {
    PatternSearch::Options options;
    options.method = PatternSearch::Method::Refined;
    options.instances = 80;
    options.iterations = iterations;
    return options;
}

PatternSearch::Found search(const GreyImage& guide, const PatternSearch::Options& options, std::uint64_t seed = 1,
                            int threads = 1) {
    return PatternSearch::run(guide, withShapes({"triangle", "leaf"}, seed), options, threads, never);
}

// The counts rise to many and fall again. Example failure: a carry is lost between two planes.
TEST(LayerCounts, counts_what_comes_and_goes) {
    LayerCounts counts(6);
    std::vector<int> expected(64, 0);
    Rng rng(1);
    std::vector<std::uint64_t> lying;
    for (int step = 0; step < 4000; ++step) {
        const bool more = lying.empty() || rng.uniform() < (step < 2000 ? 0.7 : 0.3);
        const std::size_t which = lying.empty() ? 0 : rng.below(static_cast<std::uint32_t>(lying.size()));
        const std::uint64_t mask = more ? std::uint64_t{rng.bits()} << 32 | rng.bits() : lying[which];
        std::uint64_t three = 0;
        for (int i = 0; i < 64; ++i) {
            expected[static_cast<std::size_t>(i)] += (mask >> i & 1) == 0 ? 0 : more ? 1 : -1;
            if (expected[static_cast<std::size_t>(i)] == 3) three |= std::uint64_t{1} << i;
        }
        if (more) {
            counts.add(4, mask);
            lying.push_back(mask);
        } else {
            counts.remove(4, mask);
            lying.erase(lying.begin() + static_cast<std::ptrdiff_t>(which));
        }
        ASSERT_EQ(counts.three(4), three) << step;
    }
    EXPECT_EQ(counts.three(3), 0u) << "another word is unchanged";
}

// The changes of z, tone and overlap with their weights add up to the same, whatever moves led to a
// pattern. Example failure: a rejected move leaves a trace, or a block that lies in two words is
// counted twice.
void changesAddUp(std::shared_ptr<const GreyImage> surface) {
    PatternSearch::Options options = refined(1);
    options.surface = std::move(surface);
    options.refined.zWeight = 0.7, options.refined.toneWeight = 1.3, options.refined.overlapWeight = 0.4,
    options.refined.overlapFree = 0.3;
    const GreyImage guide = ramp();
    const ShapePattern pattern = withShapes({"triangle", "leaf"});
    const SearchSpace space(guide, pattern.shapes, 1, options);
    SilhouetteScanner scanner(guide.width(), guide.height());
    Rng rng(3);
    const auto randomMask = [&] {
        const ShapeInstance instance = space.randomInstance({{0, 0}, space.pixels()}, rng);
        PixelMask mask;
        mask.draw(scanner, space.silhouette(instance.shape), {instance.centre, instance.size, instance.rotation});
        return mask;
    };
    RunningScore moved(space), fresh(space);
    std::vector<PixelMask> lying;
    double onTheWay = 0, atOnce = 0;
    for (int step = 0; step < 3000; ++step) {
        const bool takes = !lying.empty() && rng.uniform() < 0.6, puts = !takes || rng.uniform() < 0.7;
        const std::size_t which = takes ? rng.below(static_cast<std::uint32_t>(lying.size())) : 0;
        const PixelMask out = takes ? lying[which] : PixelMask{}, in = puts ? randomMask() : PixelMask{};
        const double limit = rng.uniform(-30, 30), limited = moved.propose(out, in, limit), change = moved.propose(out, in);
        if (change <= limit)
            ASSERT_EQ(limited, change);
        else
            ASSERT_GT(limited, limit) << "the bound rejects only what the change itself would";
        if (rng.uniform() < 0.5) continue;
        moved.accept(out, in);
        onTheWay += change;
        if (takes) lying.erase(lying.begin() + static_cast<std::ptrdiff_t>(which));
        if (puts) lying.push_back(in);
    }
    ASSERT_GT(lying.size(), 20u);
    for (const PixelMask& mask : lying) {
        atOnce += fresh.propose({}, mask);
        fresh.accept({}, mask);
    }
    EXPECT_NEAR(onTheWay, atOnce, 1e-6 * guide.width() * guide.height());
    EXPECT_EQ(moved.z(), fresh.z());
}
TEST(RunningScore, changes_add_up_whatever_the_way) { changesAddUp(nullptr); }
TEST(RunningScore, changes_add_up_on_a_surface_too) { changesAddUp(stains()); }

// Tone is the mean difference after two Gaussian blurs. Example failure: means over cells instead,
// or a Gaussian of another width.
void toneIsBehindTwoGaussians(std::shared_ptr<const GreyImage> surface) {
    PatternSearch::Options options = refined(1);
    options.surface = surface;
    options.refined.zWeight = 0, options.refined.toneWeight = 1, options.refined.overlapWeight = 0;
    constexpr int kWidth = 540, kHeight = 360;
    const GreyImage guide = ramp(kWidth, kHeight);
    const ShapePattern pattern = withShapes({"triangle"});
    const SearchSpace space(guide, pattern.shapes, 1, options);
    SilhouetteScanner scanner(kWidth, kHeight);
    RunningScore score(space);
    Coverage coverage(kWidth, kHeight);
    Rng rng(5);
    PixelMask mask;
    double change = 0;
    for (int i = 0; i < 40; ++i) {
        const ShapeInstance instance = space.randomInstance({{150, 100}, {390, 260}}, rng);
        const InstancePose pose{instance.centre, instance.size, instance.rotation};
        mask.draw(scanner, space.silhouette(0), pose);
        change += score.propose({}, mask);
        score.accept({}, mask);
        coverage.add(space.silhouette(0), pose);
    }
    GreyImage drawn = coverage.picture();
    EXPECT_THAT(score.picture().pixels(), testing::ElementsAreArray(drawn.pixels()));
    if (surface) {
        const GreyImage light = resized(*surface, kWidth, kHeight);
        for (std::size_t i = 0; i < drawn.pixels().size(); ++i) drawn.pixels()[i] *= light.pixels()[i];
    }
    // The change from a black picture to this one. Everything is far from the picture's edges,
    // where a blur depends on the border.
    double expected = 0;
    for (const double sigma : {kHeight / 36.0, kHeight / 18.0}) {
        const GreyImage wanted = blurred(guide, sigma), seen = blurred(drawn, sigma);
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x)
                expected += (std::abs(double(wanted.at(x, y)) - seen.at(x, y)) - std::abs(double(wanted.at(x, y)))) / 2;
    }
    EXPECT_NEAR(change, expected, 0.03 * std::abs(expected));
}
TEST(RunningScore, tone_is_the_difference_behind_two_gaussians) { toneIsBehindTwoGaussians(nullptr); }
TEST(RunningScore, tone_on_a_surface_is_that_of_what_is_seen) { toneIsBehindTwoGaussians(stains()); }

// The running sum is exact. Example failure: a pixel under two instances is freed when one of them
// goes.
TEST(RefinedMethod, after_many_moves_z_is_that_of_a_fresh_drawing) {
    for (const GreyImage& guide : {ramp(), bars(), ramp(64, 33), ramp(1, 1), bars(200, 7)}) {
        for (const int iterations : {0, 1, 60}) {
            const auto found = search(guide, refined(iterations));
            EXPECT_EQ(measure(found.pattern, guide).z, found.summary.z)
                << guide.width() << " x " << guide.height() << ", " << iterations;
        }
    }
    const auto million = search(ramp(), refined(1000));
    EXPECT_EQ(million.summary.evaluations, 1'000'000);
    EXPECT_EQ(measure(million.pattern, ramp()).z, million.summary.z);
}

TEST(RefinedMethod, on_a_surface_z_is_that_of_a_fresh_drawing_too) {
    PatternSearch::Options options = refined(60);
    options.surface = stains();
    for (const GreyImage& guide : {ramp(), bars(), ramp(64, 33)}) {
        const auto found = search(guide, options);
        EXPECT_EQ(measure(found.pattern, guide, options.surface.get()).z, found.summary.z);
    }
}

// Example failure: the search knows the surface, and covers dark places no more than bright ones.
TEST(RefinedMethod, reads_as_the_drawing_on_the_surface_that_it_knows) {
    GreyImage grey(300, 180, 0.35f);
    PatternSearch::Options options = refined(400);
    options.instances = 300;
    const auto onPlain = search(grey, options).pattern;
    options.surface = stains();
    const auto onStains = search(grey, options).pattern;
    const auto tone = [&](const ShapePattern& pattern) { return measure(pattern, grey, options.surface.get()).tone; };
    EXPECT_LT(tone(onStains), 0.6 * tone(onPlain));
    EXPECT_GT(measure(onStains, grey).tone, measure(onPlain, grey).tone) << "on plain white it reads as stains";
}

TEST(RefinedMethod, reads_as_the_drawing_better_than_it_began_and_than_the_papers_method) {
    for (const GreyImage& guide : {ramp(300, 180), bars(300, 180)}) {
        const auto tone = [&](PatternSearch::Method method, int iterations) {
            PatternSearch::Options options = refined(iterations);
            options.method = method;
            options.instances = 160;
            return measure(search(guide, options).pattern, guide).tone;
        };
        const double found = tone(PatternSearch::Method::Refined, 100);
        EXPECT_LT(found, 0.5 * tone(PatternSearch::Method::Refined, 0));
        EXPECT_LT(found, 0.5 * tone(PatternSearch::Method::Paper, 100));
    }
}

// Example failure: z alone is minimised, which turns greys into black or white.
TEST(RefinedMethod, keeps_greys) {
    constexpr int kWidth = 300, kHeight = 180;
    PatternSearch::Options options = refined(100);
    options.instances = 300;
    const GreyImage guide = ramp(kWidth, kHeight);
    const GreyImage seen = drawWhiteOnBlack(search(guide, options).pattern, kWidth, kHeight);
    for (int fifth = 0; fifth < 5; ++fifth) {
        double wanted = 0, got = 0;
        for (int y = 0; y < kHeight; ++y)
            for (int x = fifth * 60; x < fifth * 60 + 60; ++x) {
                wanted += guide.at(x, y) / (60 * kHeight);
                got += seen.at(x, y) / (60 * kHeight);
            }
        EXPECT_NEAR(got, wanted, 0.05) << fifth;
    }
}

TEST(RefinedMethod, overlap_is_what_its_weight_allows) {
    PatternSearch::Options options = refined(60);
    const GreyImage guide = bars();
    const auto overlap = [&](double weight) {
        options.refined.overlapWeight = weight;
        return measure(search(guide, options).pattern, guide).overlap;
    };
    EXPECT_LT(overlap(1), 0.5 * overlap(0));
    // Shapes use the free overlap, and no more.
    options.refined.overlapFree = 0.3;
    EXPECT_GT(overlap(1), 0.25);
    EXPECT_LT(overlap(1), 0.32);
}

// Example failure: shapes lie on each other where the drawing is grey, although there is room side
// by side.
TEST(RefinedMethod, overlap_is_free_in_white_alone) {
    PatternSearch::Options options = refined(60);
    options.refined.overlapWeight = 1, options.refined.overlapFree = 1;
    GreyImage grey = bars();
    for (float& value : grey.pixels()) value *= 0.6f;
    EXPECT_LT(measure(search(grey, options).pattern, grey).overlap,
              0.1 * measure(search(bars(), options).pattern, bars()).overlap);
}

TEST(RefinedMethod, keeps_every_instance_within_the_settings) {
    PatternSearch::Options options = refined(60);
    options.size = {0.05, 0.12};
    options.tilt = 0.3, options.turn = 0.5;
    const auto found = search(bars(), options);
    EXPECT_LE(found.pattern.instances.size(), options.instances);
    std::set<std::uint32_t> ids;
    constexpr double kStep = 1e-6;
    for (const ShapeInstance& i : found.pattern.instances) {
        EXPECT_TRUE(ids.insert(i.id).second);
        EXPECT_LT(i.shape, 2u);
        EXPECT_TRUE(i.centre.x >= 0 && i.centre.x <= found.pattern.aspect() && i.centre.y >= 0 && i.centre.y <= 1);
        EXPECT_TRUE(i.size >= 0.05 - kStep && i.size <= 0.12 + kStep) << i.size;
        EXPECT_LE(std::max(std::abs(i.rotation.x), std::abs(i.rotation.y)), 0.3 + kStep);
        EXPECT_LE(std::abs(i.rotation.z), 0.5 + kStep);
    }
}

TEST(RefinedMethod, the_same_seed_gives_the_same_pattern_on_any_number_of_threads) {
    const auto one = search(ramp(), refined(10), 7, 1);
    EXPECT_TRUE(same(one.pattern.instances, search(ramp(), refined(10), 7, 3).pattern.instances));
    EXPECT_FALSE(same(one.pattern.instances, search(ramp(), refined(10), 8, 1).pattern.instances));
}

// The caller plans the run's length after it has begun. Example failure: until then the run cools
// differently from a run of that many iterations.
TEST(RefinedMethod, a_planned_run_is_repeated_by_its_iterations) {
    for (const int toldAt : {0, 5, 20}) {
        const auto planned =
            PatternSearch::run(ramp(), withShapes({"triangle", "leaf"}), refined(std::numeric_limits<int>::max()), 1, never,
                               [&](const PatternSearch::Progress& now) -> std::optional<int> {
                                   if (now.iterations < toldAt) return std::nullopt;
                                   return 60;
                               });
        EXPECT_EQ(planned.summary.reason, StopReason::Time);
        const auto repeated = search(ramp(), refined(planned.summary.iterations));
        EXPECT_TRUE(same(planned.pattern.instances, repeated.pattern.instances)) << toldAt;
        if (toldAt <= 5)
            EXPECT_EQ(planned.summary.iterations, 60);
        else
            EXPECT_GT(planned.summary.iterations, 5 * toldAt)
                << "a late plan is lengthened so that the whole cooling still follows";
    }
}

// A pattern is changed in one place, as when a lamp post turns out to stand before it. Example
// failure: the rest is moved, recoloured or regrouped.
TEST(RefinedMethod, goes_on_from_a_pattern_and_leaves_all_but_a_region_alone) {
    const GreyImage guide = bars();
    const auto first = search(guide, refined(20));
    GreyImage changed = guide;  // its left half becomes dark
    for (int y = 0; y < guide.height(); ++y)
        for (int x = 0; x < guide.width() / 2; ++x) changed.at(x, y) = 0;
    PatternSearch::Options options = refined(20);
    options.region = PatternSearch::Region{{0, 0}, {0.5 * first.pattern.aspect(), 1}};
    const auto mended = PatternSearch::run(changed, first.pattern, options, 1, never);
    EXPECT_EQ(measure(mended.pattern, changed).z, mended.summary.z);
    EXPECT_LT(mended.summary.z, 0.5 * measure(first.pattern, changed).z);

    std::map<std::uint32_t, ShapeInstance> before;
    for (const ShapeInstance& instance : first.pattern.instances) before[instance.id] = instance;
    std::size_t elsewhere = 0;
    for (const ShapeInstance& instance : mended.pattern.instances) {
        const bool was = before.contains(instance.id);
        if (was) {
            EXPECT_EQ(instance.group, before[instance.id].group);
            EXPECT_EQ(instance.colour, before[instance.id].colour);
        }
        if (options.region->contains(instance.centre)) continue;
        ++elsewhere;
        ASSERT_TRUE(was) << instance.id;
        EXPECT_TRUE(same({instance}, {before[instance.id]}));
    }
    EXPECT_EQ(elsewhere, static_cast<std::size_t>(std::count_if(
                             first.pattern.instances.begin(), first.pattern.instances.end(),
                             [&](const ShapeInstance& instance) { return !options.region->contains(instance.centre); })));
}

// Example failure: the search begins hot and destroys the given pattern.
TEST(RefinedMethod, going_on_makes_a_pattern_no_worse) {
    const GreyImage guide = bars();
    const auto first = search(guide, refined(40));
    const auto second = PatternSearch::run(guide, first.pattern, refined(3), 1, never);
    EXPECT_LT(second.summary.z, 1.2 * first.summary.z);
    EXPECT_TRUE(same(PatternSearch::run(guide, first.pattern, refined(0), 1, never).pattern.instances, first.pattern.instances));
}

TEST(PatternSearch, a_budget_of_time_becomes_iterations_once_the_speed_is_known) {
    EXPECT_EQ(PatternSearch::iterationsWithin(10, 0, 5), std::nullopt);
    EXPECT_EQ(PatternSearch::iterationsWithin(10, 30, 0.5), std::nullopt);
    const auto planned = PatternSearch::iterationsWithin(10, 60, 1);
    ASSERT_TRUE(planned);
    EXPECT_GE(*planned, 600);
    EXPECT_LE(*planned, 800);
    EXPECT_GT(PatternSearch::iterationsWithin(1e9, 2'000'000'000, 1e8).value(), 0) << "no overflow";
}

TEST(RefinedMethod, stops_below_the_target_and_when_it_is_asked_to) {
    PatternSearch::Options options = refined(100'000);
    options.targetZ = 0.15;
    const auto found = search(bars(), options);
    EXPECT_EQ(found.summary.reason, StopReason::TargetReached);
    EXPECT_LT(found.summary.z, 0.15);
    const auto stopped = PatternSearch::run(bars(), withShapes({"triangle"}), refined(1000), 1,
                                            [](const PatternSearch::Progress& now) -> std::optional<StopReason> {
                                                if (now.iterations == 3) return StopReason::Interrupted;
                                                return std::nullopt;
                                            });
    EXPECT_EQ(stopped.summary.iterations, 3);
    EXPECT_EQ(stopped.summary.reason, StopReason::Interrupted);
}

// Example failure: hidden instances cost nothing, and a pattern fills up with them.
TEST(RefinedMethod, keeps_no_instance_that_shows_nothing) {
    PatternSearch::Options options = refined(100);
    options.instances = 100'000;
    options.size = {0.5, 0.5};
    EXPECT_EQ(search(GreyImage(1, 1, 1.0f), options).pattern.instances.size(), 1u);
}

TEST(RefinedMethod, a_black_guide_gives_no_shapes_and_a_white_one_is_filled) {
    EXPECT_EQ(search(GreyImage(96, 54, 0.0f), refined(20)).pattern.instances.size(), 0u);
    EXPECT_LT(search(GreyImage(96, 54, 1.0f), refined(100)).summary.z, 0.1);
}

}  // namespace
}  // namespace fantascope::pattern
