#pragma once
// A wall that is watched while a show runs on it.

#include "vision/projected_wall.h"
#include "vision/watch/wall_watch.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fantascope::vision {

// White leaves on black, as a pattern has them: `count` ellipses at random.
inline RgbaImage leaves(glm::ivec2 size, int count, std::uint64_t seed) {
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

// What a calibration would have found on the wall; or, without its texture, what a plan says.
inline ProjectorMap mapOf(const ProjectedWall& wall, bool isSurveyed = true) {
    constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
    const glm::ivec2 size = wall.camera.size;
    ProjectorMap map{Image<glm::vec2>(size.x, size.y, glm::vec2(kUnknown)), GreyImage(size.x, size.y), 0, 0};
    for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x) {
            const glm::dvec3 point = wall.hit(wall.camera.rayThrough({x + 0.5, y + 0.5}));
            const auto at = wall.projector.pixelFromWorld(point);
            if (!at || !wall.projector.inPicture(*at)) continue;
            map.at.at(x, y) = *at;
            map.light.at(x, y) = isSurveyed ? static_cast<float>(wall.strength * wall.reflectance(point.x, point.y)) : 1.0f;
        }
    if (isSurveyed && wall.blur > 0) map.light = blurred(map.light, wall.blur);  // as the camera sees it
    return map;
}

inline WatchedOutput watchedOn(const ProjectedWall& wall, bool isSurveyed = true) {
    return {mapOf(wall, isSurveyed), isSurveyed, wall.projector.size, wall.gamma, {}};
}

// Turns a device about its own axes (degrees) and moves it (metres).
inline CameraModel bumped(CameraModel device, glm::dvec3 turn, glm::dvec3 move = glm::dvec3(0)) {
    device.pose.position += device.pose.worldFromLocal * move;
    device.pose.worldFromLocal = device.pose.worldFromLocal * rotationXyz({radians(turn.x), radians(turn.y), radians(turn.z)});
    return device;
}

inline ProjectedWall brickWall() {
    ProjectedWall wall = slantedWall();
    wall.reflectance = bricks;
    wall.blur = 1;
    return wall;
}

inline RgbaImage storedOf(const GreyImage& light) {
    RgbaImage picture(light.width(), light.height());
    for (std::size_t i = 0; i < light.pixels().size(); ++i) {
        const auto value = static_cast<std::uint8_t>(std::lround(255 * srgbFromLinear(std::min(1.0f, light.pixels()[i]))));
        picture.pixels()[i] = {value, value, value, 255};
    }
    return picture;
}

}  // namespace fantascope::vision
