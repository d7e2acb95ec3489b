#pragma once

#include "core/result.h"

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <numbers>
#include <optional>
#include <string>

namespace fantascope {

// Angles are degrees in files and radians inside. All conversions use this expression, so that a
// default equals the same value from a file to the bit.
constexpr double radians(double degrees) { return degrees * std::numbers::pi / 180; }

// A projective map of the plane. Instances are named target-from-source: projectorFromCanvas(point
// on the canvas) is a projector pixel.
class Homography {
public:
    Homography() = default;  // the identity
    explicit Homography(const glm::dmat3& matrix) : matrix_(matrix) {}

    // The map from four source points to four target points. Both quadrilaterals run top-left,
    // top-right, bottom-right, bottom-left.
    // Error: three points of either are collinear, the corners are crossed or folded (the
    // quadrilateral must be convex), or a coordinate is not finite.
    static Result<Homography> fromCorners(const std::array<glm::dvec2, 4>& source, const std::array<glm::dvec2, 4>& target);

    // Inline: pictures call it for every pixel.
    glm::dvec2 operator()(glm::dvec2 point) const {
        const glm::dvec3 mapped = matrix_ * glm::dvec3(point, 1.0);
        return glm::dvec2(mapped) / mapped.z;
    }
    Homography inverse() const;
    Homography operator*(const Homography& first) const {
        return Homography(matrix_ * first.matrix_);
    }                                                     // `first` is applied first
    const glm::dmat3& matrix() const { return matrix_; }  // column vectors: (x, y, w) = matrix * (x, y, 1)

private:
    glm::dmat3 matrix_{1.0};
};

// The corners of [0, width] x [0, height], clockwise from the top left, y down.
std::array<glm::dvec2, 4> rectangleCorners(double width, double height);

// Why four corners cannot be a picture's (folded, crossed, degenerate); nothing: they can.
std::optional<std::string> whyNotConvex(const std::array<glm::dvec2, 4>& corners);

// Rotation about x, then y, then z (radians), each right-handed: R = Rz * Ry * Rx.
glm::dmat3 rotationXyz(glm::dvec3 angles);

// A rigid pose: a device's position and orientation. Camera axes: x right, y down, z forward.
struct Pose {
    glm::dmat3 worldFromLocal{1.0};  // columns: right, down, forward in world axes
    glm::dvec3 position{0.0};        // metres

    // Looks from `position` at `target`, the picture's top towards `up`. Error: target equals
    // position, or `up` is zero or along the view.
    static Result<Pose> lookingAt(glm::dvec3 position, glm::dvec3 target, glm::dvec3 up = {0, 1, 0});
    glm::dvec3 localFromWorld(glm::dvec3 point) const;
};

}  // namespace fantascope
