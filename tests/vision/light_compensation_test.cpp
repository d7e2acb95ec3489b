// Light of one or two projectors on walls that are not evenly white: the light on the wall is
// computed place by place with the factors, and held against the even light that is wanted.

#include "vision/light_compensation.h"

#include "vision/projected_wall.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

namespace fantascope::vision {
namespace {

// Stains, grass and stone: reflectances from a tenth to seven tenths.
double stained(double x, double y) {
    const double stain = std::sin(2.1 * x + 0.7) * std::cos(1.7 * y - 0.4), grain = 0.05 * std::sin(31 * x) * std::sin(27 * y);
    return std::clamp(0.36 + 0.3 * stain + grain, 0.1, 0.7);
}
double even(double, double) { return 0.6; }

// What a camera would have found of a wall's projector.
ProjectorMap mapOf(const ProjectedWall& wall) {
    ProjectorMap map{Image<glm::vec2>(wall.camera.size.x, wall.camera.size.y, glm::vec2(NAN)),
                     GreyImage(wall.camera.size.x, wall.camera.size.y)};
    for (int y = 0; y < wall.camera.size.y; ++y)
        for (int x = 0; x < wall.camera.size.x; ++x) {
            const glm::dvec3 point = wall.hit(wall.camera.rayThrough({x + 0.5, y + 0.5}));
            const auto pixel = wall.projector.pixelFromWorld(point);
            if (!pixel || !wall.projector.inPicture(*pixel)) continue;
            map.at.at(x, y) = glm::vec2(*pixel);
            map.light.at(x, y) = static_cast<float>(wall.strength * wall.reflectance(point.x, point.y));
            ++map.lit, ++map.known;
        }
    return map;
}

GreyImage shares(const ProjectedWall& wall, const std::function<double(double x)>& share) {
    GreyImage shares(wall.projector.size.x, wall.projector.size.y);
    for (int y = 0; y < shares.height(); ++y)
        for (int x = 0; x < shares.width(); ++x) shares.at(x, y) = static_cast<float>(share((x + 0.5) / shares.width()));
    return shares;
}
GreyImage whole(const ProjectedWall& wall) {
    return shares(wall, [](double) { return 1.0; });
}

// The light of a white canvas at camera pixels, with factors that have shifted by `shift` projector
// pixels.
struct OnTheWall {
    const ProjectedWall* wall;
    const ProjectorMap* map;
    const GreyImage* share;
    const GreyImage* gain;
};
std::vector<double> lightOf(const std::vector<OnTheWall>& outputs, glm::dvec2 shift = glm::dvec2(0)) {
    std::vector<double> light;
    const ProjectorMap& first = *outputs[0].map;
    for (int y = 0; y < first.at.height(); ++y)
        for (int x = 0; x < first.at.width(); ++x) {
            double sum = 0, known = 0;
            for (const auto& [wall, map, share, gain] : outputs) {
                if (!map->isKnown(x, y)) continue;
                const glm::dvec2 pixel(map->at.at(x, y));
                const auto at = [&](const GreyImage& picture, glm::dvec2 place) {
                    return picture.at(std::clamp(static_cast<int>(place.x), 0, picture.width() - 1),
                                      std::clamp(static_cast<int>(place.y), 0, picture.height() - 1));
                };
                known += at(*share, pixel);
                sum += map->light.at(x, y) * at(*share, pixel) * at(*gain, pixel + shift);
            }
            if (known > 0.95) light.push_back(sum);
        }
    return light;
}

double spreadOf(const std::vector<double>& light) {
    double mean = 0, spread = 0;
    for (const double one : light) mean += one / static_cast<double>(light.size());
    for (const double one : light) spread += std::abs(one - mean) / static_cast<double>(light.size());
    return spread / mean;
}

LightCompensation compensated(const ProjectedWall& wall, const LightBounds& bounds) {
    const ProjectorMap map = mapOf(wall);
    const GreyImage share = whole(wall);
    const LitOutput output{&map, &share};
    return *compensateLight({&output, 1}, bounds);
}

TEST(LightCompensation, makes_the_light_on_a_stained_wall_even) {
    ProjectedWall wall = slantedWall();
    wall.reflectance = stained;
    const ProjectorMap map = mapOf(wall);
    const GreyImage share = whole(wall), none(share.width(), share.height(), 1);
    const LightCompensation made = compensated(wall, {0.1, 0.05});
    const double before = spreadOf(lightOf({{&wall, &map, &share, &none}})),
                 after = spreadOf(lightOf({{&wall, &map, &share, &made.gains[0]}}));
    EXPECT_GT(before, 0.25);
    EXPECT_LT(after, 0.25 * before);
    EXPECT_NEAR(made.spreadBefore, before, 0.1 * before);
    EXPECT_LT(made.spread, after + 0.01);
}

TEST(LightCompensation, stays_within_its_bounds_and_says_what_it_costs) {
    ProjectedWall wall = slantedWall();
    wall.reflectance = stained;
    double keptBefore = 0;
    for (const double least : {0.2, 0.4, 0.7, 1.0}) {
        const LightCompensation made = compensated(wall, {least, 0.1});
        for (const float gain : made.gains[0].pixels()) {
            ASSERT_GE(gain, static_cast<float>(least) - 1e-4f);
            ASSERT_LE(gain, 1.0001f);
        }
        EXPECT_GT(made.kept, keptBefore) << "the more may be dimmed, the more light it costs";
        keptBefore = made.kept;
        EXPECT_LT(made.tooBright, 0.13) << least;
    }
    EXPECT_NEAR(keptBefore, 1, 1e-3) << "nothing may be dimmed";
    EXPECT_NEAR(compensated(wall, {0.05, 0.1}).tooDark, 0.1, 0.04);
    EXPECT_GT(compensated(wall, {0.05, 0.3}).kept, compensated(wall, {0.05, 0.02}).kept + 0.1)
        << "whoever lets dark places stay dark keeps more light";
}

TEST(LightCompensation, leaves_an_even_wall_alone) {
    ProjectedWall wall = slantedWall();
    wall.reflectance = even;
    const LightCompensation made = compensated(wall, {});
    for (const float gain : made.gains[0].pixels()) ASSERT_NEAR(gain, 1, 1e-3);
    EXPECT_EQ(made.tooDark, 0);
}

// Example failure: factors as sharp as the stain, which half a pixel later is a bright and a dark
// line.
TEST(LightCompensation, makes_no_edges_if_the_projector_is_half_a_pixel_off) {
    ProjectedWall wall = slantedWall();
    wall.reflectance = [](double x, double y) { return x + 0.3 * y > 0.5 ? 0.6 : 0.12; };
    const ProjectorMap map = mapOf(wall);
    const GreyImage share = whole(wall);
    const LightCompensation made = compensated(wall, {0.15, 0.1});
    const auto there = lightOf({{&wall, &map, &share, &made.gains[0]}}),
               off = lightOf({{&wall, &map, &share, &made.gains[0]}}, {0.5, 0.5});
    double worst = 0;
    for (std::size_t i = 0; i < there.size(); ++i) worst = std::max(worst, std::abs(off[i] / there[i] - 1));
    EXPECT_LT(worst, 0.2) << "a step in the factors would be fivefold";
}

// Where two pictures blend, both have the same factor.
TEST(LightCompensation, keeps_a_blend_of_two_projectors_even) {
    ProjectedWall left = slantedWall(), right = slantedWall();
    right.projector = CameraModel::fromThrowRatio(*Pose::lookingAt({2.4, 2.6, 6.2}, {1.7, 1.5, 0}), {800, 450}, 1.6, {0, 0});
    left.reflectance = right.reflectance = stained;
    const ProjectorMap maps[] = {mapOf(left), mapOf(right)};
    // Each gives what the other does not, by the place on the wall.
    const auto shareOf = [&](const ProjectedWall& wall, bool isLeft) {
        GreyImage share(wall.projector.size.x, wall.projector.size.y);
        for (int y = 0; y < share.height(); ++y)
            for (int x = 0; x < share.width(); ++x) {
                const glm::dvec3 point = wall.hit(wall.projector.rayThrough({x + 0.5, y + 0.5}));
                const double along = std::clamp((point.x - 0.7) / 0.6, 0.0, 1.0), of = along * along * (3 - 2 * along);
                share.at(x, y) = static_cast<float>(isLeft ? 1 - of : of);
            }
        return share;
    };
    const GreyImage share[] = {shareOf(left, true), shareOf(right, false)};
    const LitOutput outputs[] = {{&maps[0], &share[0]}, {&maps[1], &share[1]}};
    const LightCompensation made = *compensateLight(outputs, {0.1, 0.05});
    const GreyImage none(800, 450, 1);
    const double before = spreadOf(lightOf({{&left, &maps[0], &share[0], &none}, {&right, &maps[1], &share[1], &none}})),
                 after = spreadOf(
                     lightOf({{&left, &maps[0], &share[0], &made.gains[0]}, {&right, &maps[1], &share[1], &made.gains[1]}}));
    EXPECT_LT(after, 0.25 * before);
}

TEST(LightCompensation, needs_to_see_the_canvas) {
    const ProjectedWall wall = slantedWall();
    ProjectorMap map = mapOf(wall);
    std::ranges::fill(map.at.pixels(), glm::vec2(NAN));
    map.known = 0;
    const GreyImage share = whole(wall);
    const LitOutput output{&map, &share};
    EXPECT_FALSE(compensateLight({&output, 1}, {}));
    EXPECT_FALSE(lightByProjectorPixel(map, {800, 450}));
}

TEST(LightByProjectorPixel, is_the_walls_light_there) {
    ProjectedWall wall = slantedWall();
    wall.reflectance = [](double x, double y) { return 0.4 + 0.2 * std::sin(2 * x) * std::cos(2 * y); };
    const GreyImage light = *lightByProjectorPixel(mapOf(wall), wall.projector.size);
    for (int i = 0; i < 100; ++i) {
        const glm::ivec2 pixel(60 + i % 10 * 75, 40 + i / 10 * 40);
        const glm::dvec3 point = wall.hit(wall.projector.rayThrough(glm::dvec2(pixel) + 0.5));
        if (!wall.camera.inPicture(*wall.camera.pixelFromWorld(point))) continue;
        EXPECT_NEAR(light.at(pixel.x, pixel.y), wall.strength * wall.reflectance(point.x, point.y), 0.02);
    }
}

}  // namespace
}  // namespace fantascope::vision
