#include "theatre/stage/stage.h"

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include <algorithm>
#include <cmath>

namespace fantascope::theatre {
namespace {

constexpr double kOnFloor = 0.01;  // metres

// A point in a platform's own axes, from its centre.
glm::dvec3 inAxesOf(const Stage::Platform& platform, const glm::dvec3& point) {
    const glm::dvec3 d = point - platform.centre;
    const double c = std::cos(platform.turn), s = std::sin(platform.turn);
    return {c * d.x - s * d.z, d.y, s * d.x + c * d.z};
}

}  // namespace

glm::dvec3 Stage::Platform::point(const glm::dvec3& share) const {
    return centre + glm::angleAxis(turn, glm::dvec3(0, 1, 0)) * (share * size);
}

bool Stage::Platform::isUnder(double x, double z) const {
    const glm::dvec3 local = inAxesOf(*this, {x, centre.y, z});
    return std::abs(local.x) <= 0.5 * size.x && std::abs(local.z) <= 0.5 * size.z;
}

double Stage::Platform::distance(const glm::dvec3& point, glm::dvec3& outward) const {
    const glm::dvec3 local = inAxesOf(*this, point);
    // A platform on the floor has no way out below.
    const bool isOnFloor = centre.y - 0.5 * size.y < kOnFloor;
    const glm::dvec3 beyond =
        glm::dvec3(std::abs(local.x), isOnFloor ? local.y : std::abs(local.y), std::abs(local.z)) - 0.5 * size;
    const glm::dvec3 outside = glm::max(beyond, glm::dvec3(0));
    double distance = glm::length(outside);
    glm::dvec3 direction(0);
    if (distance > 0) {
        direction = outside / distance;
    } else {
        const int axis = beyond.y >= std::max(beyond.x, beyond.z) ? 1 : beyond.x >= beyond.z ? 0 : 2;
        distance = beyond[axis];
        direction[axis] = 1;
    }
    for (int i = 0; i < 3; ++i)
        if (local[i] < 0 && !(i == 1 && isOnFloor)) direction[i] = -direction[i];
    const double c = std::cos(turn), s = std::sin(turn);
    outward = {c * direction.x + s * direction.z, direction.y, -s * direction.x + c * direction.z};
    return distance;
}

double Stage::Area::outside(glm::dvec2 point) const { return glm::distance(point, glm::clamp(point, from, to)); }

double Stage::groundUnder(const glm::dvec3& point) const {
    double height = 0;
    for (const Platform& platform : platforms)
        if (platform.top() <= point.y && platform.isUnder(point.x, point.z)) height = std::max(height, platform.top());
    return height;
}

Result<void> Stage::checkHolders(std::size_t actors) const {
    for (const Prop& prop : props)
        if (prop.holder && prop.holder->actor >= actors)
            return Error(fmt::format("prop '{}' is held by actor {}, and there {}; let another hold it, or ask for more actors",
                                     prop.name, prop.holder->actor + 1, actors == 1 ? "is one" : fmt::format("are {}", actors)));
    return {};
}

glm::dmat4 Stage::screenFromStage(std::size_t beam) const {
    const Screen& screen = screenOf(beam);
    const glm::dvec3 origin = screen.screenFromStage(glm::dvec3(0));
    glm::dmat4 matrix(1);
    for (glm::length_t i = 0; i < 3; ++i) {
        glm::dvec3 axis(0);
        axis[i] = 1;
        matrix[i] = glm::dvec4(screen.screenFromStage(axis) - origin, 0);
    }
    matrix[3] = glm::dvec4(origin, 1);
    return matrix;
}

ScreenFrame::ScreenFrame(const Stage& stage, double left, double top, double pixel, int width, int height, std::size_t beam)
    : light_(stage.beams[beam].light),
      cosine_(std::cos(stage.screenOf(beam).turn)),
      sine_(std::sin(stage.screenOf(beam).turn)),
      left_(left),
      top_(top),
      pixel_(pixel),
      width_(width),
      height_(height) {
    const glm::dvec3 light = stage.lightOnScreen(beam);
    foot_ = pixelAt(light.x, light.y);
    focus_ = light.z / pixel;
}

}  // namespace fantascope::theatre
