#include "core/geometry.h"

#include <Eigen/LU>
#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <cmath>

namespace fantascope {

std::array<glm::dvec2, 4> rectangleCorners(double width, double height) {
    return {{{0, 0}, {width, 0}, {width, height}, {0, height}}};
}

std::optional<std::string> whyNotConvex(const std::array<glm::dvec2, 4>& corners) {
    double extent = 0;
    for (const glm::dvec2& corner : corners) {
        if (!std::isfinite(corner.x) || !std::isfinite(corner.y)) return "a coordinate is not a finite number";
        extent = std::max(extent, glm::length(corner - corners[0]));
    }
    if (extent == 0) return "all corners are one point";
    // Along the outline every corner must turn the same way; (nearly) no turn means three collinear
    // corners.
    int left = 0, right = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        const glm::dvec2 in = corners[(i + 1) % 4] - corners[i], out = corners[(i + 2) % 4] - corners[(i + 1) % 4];
        const double turn = (in.x * out.y - in.y * out.x) / (extent * extent);
        if (std::abs(turn) < 1e-9)
            return fmt::format("corners {}, {} and {} lie in a line", i + 1, (i + 1) % 4 + 1, (i + 2) % 4 + 1);
        ++(turn > 0 ? right : left);
    }
    if (left != 0 && right != 0)
        return "the corners are crossed or folded inwards; go round from the top left: top-right, bottom-right, bottom-left";
    return std::nullopt;
}

Result<Homography> Homography::fromCorners(const std::array<glm::dvec2, 4>& source, const std::array<glm::dvec2, 4>& target) {
    for (const auto* corners : {&source, &target})
        if (const auto why = whyNotConvex(*corners)) return Error(*why);
    // The direct linear transform with h33 = 1 (Hartley & Zisserman 2004, section 4.1). h33 is w at
    // the source's origin, which may not be 0. So the source is measured from its first corner,
    // whose image is finite.
    Eigen::Matrix<double, 8, 8> equations;
    Eigen::Matrix<double, 8, 1> values;
    for (int i = 0; i < 4; ++i) {
        const glm::dvec2 from = source[static_cast<std::size_t>(i)] - source[0];
        const auto [x, y] = std::pair(from.x, from.y);
        const auto [u, v] = std::pair(target[static_cast<std::size_t>(i)].x, target[static_cast<std::size_t>(i)].y);
        equations.row(2 * i) << x, y, 1, 0, 0, 0, -u * x, -u * y;
        equations.row(2 * i + 1) << 0, 0, 0, x, y, 1, -v * x, -v * y;
        values(2 * i) = u;
        values(2 * i + 1) = v;
    }
    const Eigen::Matrix<double, 8, 1> h = equations.fullPivLu().solve(values);
    const glm::dmat3 targetFromFirstCorner(h(0), h(3), h(6), h(1), h(4), h(7), h(2), h(5), 1.0);
    glm::dmat3 firstCornerFromSource(1.0);
    firstCornerFromSource[2] = {-source[0], 1.0};
    return Homography(targetFromFirstCorner * firstCornerFromSource);
}

Homography Homography::inverse() const { return Homography(glm::inverse(matrix_)); }

glm::dmat3 rotationXyz(glm::dvec3 angles) {
    const double cx = std::cos(angles.x), sx = std::sin(angles.x), cy = std::cos(angles.y), sy = std::sin(angles.y),
                 cz = std::cos(angles.z), sz = std::sin(angles.z);
    return glm::dmat3(cy * cz, cy * sz, -sy,                                    //
                      sx * sy * cz - cx * sz, sx * sy * sz + cx * cz, sx * cy,  //
                      cx * sy * cz + sx * sz, cx * sy * sz - sx * cz, cx * cy);
}

Result<Pose> Pose::lookingAt(glm::dvec3 position, glm::dvec3 target, glm::dvec3 up) {
    if (glm::length(target - position) < 1e-9) return Error("target and position are the same point; move one of them");
    const glm::dvec3 forward = glm::normalize(target - position);
    const glm::dvec3 right = glm::cross(forward, up);
    if (!(glm::length(right) > 1e-9 * glm::length(up))) return Error("'up' is zero or along the view; give another 'up'");
    const glm::dvec3 unitRight = glm::normalize(right);
    return Pose{glm::dmat3(unitRight, glm::cross(forward, unitRight), forward), position};
}

glm::dvec3 Pose::localFromWorld(glm::dvec3 point) const { return glm::transpose(worldFromLocal) * (point - position); }

}  // namespace fantascope
