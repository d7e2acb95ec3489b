#include "vision/wall_watch.h"

#include "vision/projected_wall.h"

#include <gmock/gmock.h>

#include <cmath>
#include <cstdio>
#include <limits>

namespace fantascope::vision {
namespace {

// White leaves on black, as a pattern has them: `count` ellipses at random.
RgbaImage leaves(glm::ivec2 size, int count, std::uint64_t seed) {
    RgbaImage picture(size.x, size.y, Rgba8{0, 0, 0, 255});
    Rng rng(seed);
    for (int i = 0; i < count; ++i) {
        const double x = rng.uniform() * size.x, y = rng.uniform() * size.y, turn = rng.uniform() * 3.14,
                     length = (0.015 + 0.02 * rng.uniform()) * size.x, width = length * 0.4;
        for (int row = std::max(0, static_cast<int>(y - length)); row < std::min<double>(size.y, y + length); ++row)
            for (int column = std::max(0, static_cast<int>(x - length)); column < std::min<double>(size.x, x + length);
                 ++column) {
                const double u = (column - x) * std::cos(turn) + (row - y) * std::sin(turn),
                             v = (row - y) * std::cos(turn) - (column - x) * std::sin(turn);
                if (u * u / (length * length) + v * v / (width * width) < 1) picture.at(column, row) = {255, 255, 255, 255};
            }
    }
    return picture;
}

// What a calibration would have found on the wall.
ProjectorMap mapOf(const ProjectedWall& wall) {
    constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
    const glm::ivec2 size = wall.camera.size;
    ProjectorMap map{Image<glm::vec2>(size.x, size.y, glm::vec2(kUnknown)), GreyImage(size.x, size.y), 0, 0};
    for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x) {
            const glm::dvec3 point = wall.hit(wall.camera.rayThrough({x + 0.5, y + 0.5}));
            const auto at = wall.projector.pixelFromWorld(point);
            if (!at || !wall.projector.inPicture(*at)) continue;
            map.at.at(x, y) = *at;
            map.light.at(x, y) = static_cast<float>(wall.strength * wall.reflectance(point.x, point.y));
        }
    return map;
}

// Turns a projector about its own axes (degrees) and moves it (metres).
CameraModel bumped(CameraModel projector, glm::dvec3 turn, glm::dvec3 move) {
    projector.pose.position += projector.pose.worldFromLocal * move;
    projector.pose.worldFromLocal =
        projector.pose.worldFromLocal * rotationXyz({radians(turn.x), radians(turn.y), radians(turn.z)});
    return projector;
}

// The rms error of a sight over the picture, projector pixels.
double errorOf(const Homography& found, const ProjectedWall& before, const ProjectedWall& now) {
    double sum = 0;
    int count = 0;
    const glm::ivec2 size = before.projector.size;
    for (int i = 0; i < 81; ++i) {
        const glm::dvec2 at((0.1 + 0.8 * (i % 9) / 8) * size.x, (0.1 + 0.8 * (i / 9) / 8) * size.y);
        const auto truth = now.projector.pixelFromWorld(before.hit(before.projector.rayThrough(at)));
        const glm::dvec2 off = found(at) - *truth;
        sum += off.x * off.x + off.y * off.y;
        ++count;
    }
    return std::sqrt(sum / count);
}

TEST(WallWatch, finds_how_far_a_projector_was_turned) {
    for (const double degrees : {0.0, 0.05, 0.3, 1.0, 1.6}) {
        ProjectedWall wall = slantedWall();
        wall.reflectance = bricks;
        wall.blur = 1;
        const WatchedOutput watched{mapOf(wall), true, wall.projector.size, wall.gamma};
        WallWatch watch({watched}, wall.camera.size);
        ASSERT_TRUE(watch.watches(0));
        ProjectedWall now = wall;
        now.projector = bumped(wall.projector, {degrees * 0.5, degrees, degrees * 0.7}, {0, 0, 0});
        Rng rng(3);
        for (int i = 0; i < 8; ++i) {
            const RgbaImage shown = leaves(wall.projector.size, 160, 7 + static_cast<std::uint64_t>(i) / 4);
            const GreyImage seen = now.seen(shown, rng);
            RgbaImage picture(seen.width(), seen.height());
            for (std::size_t p = 0; p < seen.pixels().size(); ++p) {
                const auto value = static_cast<std::uint8_t>(std::lround(255 * srgbFromLinear(seen.pixels()[p])));
                picture.pixels()[p] = {value, value, value, 255};
            }
            const GreyImage light = watch.lightOf(0, shown);
            const auto sights = watch.look(picture, {&light});
            if (!sights[0]) {
                std::printf("%g: nothing\n", degrees);
                continue;
            }
            std::printf("%g: moved %.2f error %.3f sigma %.3f gain %.3f agree %.3f used %.3f\n", degrees,
                        rmsMovement(sights[0]->shownFromPlace, {0, 0}, wall.projector.size),
                        errorOf(sights[0]->shownFromPlace, wall, now), sights[0]->sigma, sights[0]->gain, sights[0]->agreement,
                        sights[0]->used);
        }
    }
}

}  // namespace
}  // namespace fantascope::vision
