#include "vision/map_check.h"

#include "tests/vision/projected_wall.h"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>

namespace fantascope::vision {
namespace {

using Axis = StructuredLight::Axis;

// The map of a wall, as it is.
ProjectorMap mapOf(const ProjectedWall& wall) {
    const glm::ivec2 size = wall.camera.size;
    ProjectorMap map{Image<glm::vec2>(size.x, size.y, glm::vec2(NAN)), GreyImage(size.x, size.y), 0, 0};
    for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x) {
            const glm::dvec2 at = wall.projectorAt({x + 0.5, y + 0.5});
            if (!wall.projector.inPicture(at)) continue;
            const glm::dvec3 point = wall.hit(wall.camera.rayThrough({x + 0.5, y + 0.5}));
            map.at.at(x, y) = at;
            map.light.at(x, y) = static_cast<float>(wall.strength * wall.reflectance(point.x, point.y));
            ++map.lit, ++map.known;
        }
    return map;
}

// How far a wall's light lies from where a map of another says. `hide`: changes what is seen.
double movedOn(ProjectedWall wall, const ProjectorMap& map, const std::function<void(GreyImage&)>& hide = {}) {
    const StructuredLight light(wall.projector.size, 32);
    Rng rng(1);
    double moved = 0;
    for (const Axis axis : {Axis::Across, Axis::Down}) {
        const std::size_t pair = light.firstPhase(axis);
        GreyImage difference = wall.seen(light.picture(pair, false, wall.gamma), rng);
        const GreyImage complement = wall.seen(light.picture(pair, true, wall.gamma), rng);
        for (std::size_t i = 0; i < difference.pixels().size(); ++i) difference.pixels()[i] -= complement.pixels()[i];
        if (hide) hide(difference);
        moved = std::hypot(moved, movedSince(map, light, axis, difference).value());
    }
    return moved;
}

ProjectedWall brickWall() {
    ProjectedWall wall = slantedWall();
    wall.reflectance = bricks;
    return wall;
}

ProjectedWall turned(ProjectedWall wall, glm::dvec3 lookAt) {
    wall.projector = CameraModel::fromThrowRatio(*Pose::lookingAt({-1.6, 2.9, 6}, lookAt), wall.projector.size, 1.6, {0, 0});
    return wall;
}

TEST(MapCheck, finds_still_what_stands_still) {
    const ProjectedWall wall = brickWall();
    EXPECT_LT(movedOn(wall, mapOf(wall)), 0.25);
}

TEST(MapCheck, finds_what_has_moved_a_little_or_far) {
    const ProjectedWall wall = brickWall();
    const ProjectorMap map = mapOf(wall);
    for (const double metres : {0.005, 0.2, 0.7}) {
        const ProjectedWall then = turned(wall, {0.2 + metres, 1.5, 0});
        const glm::dvec2 middle{240, 135};
        const double moved = glm::distance(wall.projectorAt(middle), then.projectorAt(middle)), found = movedOn(then, map);
        if (moved < 8)
            EXPECT_NEAR(found, moved, 0.3 + 0.2 * moved);
        else
            EXPECT_GT(found, 2);
    }
}

// A turn about the middle moves the sides against each other. Example failure: they cancel out.
TEST(MapCheck, finds_a_turn_about_the_middle) {
    const ProjectedWall wall = brickWall();
    ProjectedWall then = wall;
    then.projector = CameraModel::fromThrowRatio(*Pose::lookingAt({-1.6, 2.9, 6}, {0.2, 1.5, 0}, {0.01, 1, 0}),
                                                 wall.projector.size, 1.6, {0, 0});
    EXPECT_GT(movedOn(then, mapOf(wall)), 0.8);
}

// Somebody stands before a third of the picture.
TEST(MapCheck, does_not_take_somebody_for_a_movement) {
    const ProjectedWall wall = brickWall();
    const auto hide = [](GreyImage& difference) {
        for (int y = 0; y < difference.height(); ++y)
            for (int x = 150; x < 250; ++x) difference.at(x, y) = 0;
    };
    EXPECT_LT(movedOn(wall, mapOf(wall), hide), 0.3);
}

TEST(MapCheck, says_nothing_of_a_map_that_knows_nothing) {
    ProjectorMap map = mapOf(brickWall());
    for (glm::vec2& at : map.at.pixels()) at = glm::vec2(NAN);
    const GreyImage nothing(map.at.width(), map.at.height());
    EXPECT_FALSE(movedSince(map, StructuredLight({800, 450}, 32), Axis::Down, nothing));
}

}  // namespace
}  // namespace fantascope::vision
