// What the surface gives back, measured while a show runs on it.

#include "vision/watched_wall.h"

#include <gmock/gmock.h>

#include <functional>

namespace fantascope::vision {
namespace {

// A lawn: blades, and bald patches.
double grass(double x, double y) {
    return 0.22 + 0.06 * std::sin(160 * x + 9 * std::sin(23 * y)) * std::sin(90 * y) +
           0.08 * std::sin(2.1 * x) * std::sin(2.7 * y + 1);
}
// Gravel: stones of many greys.
double gravel(double x, double y) {
    const double column = std::floor(x / 0.03), row = std::floor(y / 0.025),
                 grey = std::sin(12.9898 * column + 78.233 * row) * 43758.5453;
    return 0.28 + 0.3 * (grey - std::floor(grey)) + 0.05 * std::sin(1.3 * x + y);
}

using Reflectance = std::function<double(double x, double y)>;

// A wall that was surveyed, and a show of leaves that sway a little on it.
struct ShowOnWall {
    explicit ShowOnWall(const Reflectance& surveyed) {
        wall.reflectance = surveyed;
        watch.emplace(std::vector<std::optional<WatchedOutput>>{watchedOn(wall)}, wall.camera.size);
    }
    // From now on the wall is another one.
    void becomes(const Reflectance& reflectance) {
        ProjectedWall other = brickWall();
        other.reflectance = reflectance;
        other.strength = wall.strength, other.ambient = wall.ambient;
        wall = other;
    }
    void see(int count, const std::function<void(GreyImage&)>& disturb = {}) {
        for (int i = 0; i < count; ++i) {
            const RgbaImage shown = leaves(wall.projector.size, 220, 300 + ++pictures % 5);
            GreyImage seen = wall.seen(shown, rng);
            if (disturb) disturb(seen);
            const GreyImage light = watch->lightOf(0, shown);
            watch->look(storedOf(seen), {&light});
            watch->measureSurface(0);
        }
    }
    // The mean of the factors that were measured where `counts`, by places on the wall; and how far
    // they are from it.
    struct Mean {
        double factor = 0, spread = 0;
        int blocks = 0;
    };
    Mean factors(const std::function<bool(glm::dvec2 wall)>& counts) const {
        const WallChange change = watch->surfaceChange(0);
        Mean mean;
        double squares = 0;
        for (int y = 0; y < change.factor.height(); ++y)
            for (int x = 0; x < change.factor.width(); ++x) {
                const glm::dvec3 point = wall.hit(wall.projector.rayThrough((glm::dvec2(x, y) + 0.5) * change.block));
                if (change.sigma.at(x, y) <= 0 || !counts({point.x, point.y})) continue;
                const double factor = change.at((glm::dvec2(x, y) + 0.5) * change.block);
                ++mean.blocks;
                mean.factor += factor;
                squares += factor * factor;
            }
        mean.factor /= mean.blocks;
        mean.spread = std::sqrt(std::max(0.0, squares / mean.blocks - mean.factor * mean.factor));
        return mean;
    }
    ProjectedWall wall = brickWall();
    std::optional<WallWatch> watch;
    Rng rng{21};
    std::uint64_t pictures = 0;
};

bool everywhere(glm::dvec2) { return true; }

constexpr glm::dvec2 kSpot(0.4, 1.4);  // the stain's middle, metres
bool inStain(glm::dvec2 at) { return glm::distance(at, kSpot) < 0.35; }
bool farFromStain(glm::dvec2 at) { return glm::distance(at, kSpot) > 0.75; }
Reflectance stainedBy(const Reflectance& wall, double share) {
    return [=](double x, double y) { return wall(x, y) * (glm::distance(glm::dvec2(x, y), kSpot) < 0.5 ? share : 1); };
}

// Example failures: the texture of the surveyed wall is taken for a change; small leaves that the
// camera blurs count as a darker wall.
TEST(WallReflectance, is_what_the_calibration_saw_while_nothing_changes) {
    for (const Reflectance& wall : {Reflectance(bricks), Reflectance(grass), Reflectance(gravel)}) {
        ShowOnWall show(wall);
        show.see(20);
        const auto all = show.factors(everywhere);
        EXPECT_GT(all.blocks, 200);
        EXPECT_NEAR(all.factor, 1, 0.03);
        EXPECT_LT(all.spread, 0.06);
        EXPECT_EQ(show.watch->surfaceChange(0).pictures, 20);
    }
}

TEST(WallReflectance, finds_a_stain_that_was_not_there_before_and_one_that_is_gone) {
    for (const double share : {0.45, 1.4}) {
        ShowOnWall show(gravel);
        show.see(6);
        show.becomes(stainedBy(gravel, share));
        show.see(36);
        const auto stain = show.factors(inStain), other = show.factors(farFromStain);
        EXPECT_GT(stain.blocks, 8);
        EXPECT_NEAR(stain.factor / other.factor, share, 0.07);
        EXPECT_NEAR(other.factor, 1, 0.04);
        EXPECT_LT(other.spread, 0.05);
    }
}

// Fog, a dim lamp, the camera's exposure and other light: nothing of that is the wall's. Example
// failure: smooth light of a lamp makes the wall brighter.
TEST(WallReflectance, counts_nothing_that_is_common_to_the_picture) {
    ShowOnWall show(gravel);
    show.see(14);
    show.wall.strength *= 0.6;
    show.wall.ambient += 0.05;
    show.see(30, [](GreyImage& seen) {
        for (int y = 0; y < seen.height(); ++y)
            for (int x = 0; x < seen.width(); ++x) seen.at(x, y) += 0.0002f * static_cast<float>(x);  // a lamp at one side
    });
    const auto all = show.factors(everywhere);
    EXPECT_NEAR(all.factor, 1, 0.03);
    EXPECT_LT(all.spread, 0.06);
}

// Somebody stands at one place, others walk. Example failure: a dark coat becomes a dark wall.
TEST(WallReflectance, people_are_not_in_it) {
    ShowOnWall show(gravel);
    int step = 0;
    show.see(40, [&](GreyImage& seen) {
        const int walker = (step++ * 37) % seen.width();
        for (int y = seen.height() / 3; y < seen.height(); ++y)
            for (int x = 0; x < seen.width(); ++x)
                if (std::abs(x - walker) < 18 || std::abs(x - seen.width() / 2) < 14) seen.at(x, y) = 0.03f;
    });
    const auto all = show.factors(everywhere);
    EXPECT_GT(all.blocks, 150);
    EXPECT_NEAR(all.factor, 1, 0.03);
    EXPECT_LT(all.spread, 0.06);
}

}  // namespace
}  // namespace fantascope::vision
