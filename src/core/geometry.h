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

// Angles are degrees in files and radians inside. One expression for all of them: a default equals,
// to the bit, what a file gives.
constexpr double radians(double degrees) { return degrees * std::numbers::pi / 180; }

// A projective map of the plane, named target-from-source where one is held:
// projectorFromCanvas(point on the canvas) is a projector pixel.
class Homography {
public:
    Homography() = default;  // the identity
    explicit Homography(const glm::dmat3& matrix) : matrix_(matrix) {}

    // The map that carries each of four source points to its target. Both quadrilaterals run
    // top-left, top-right, bottom-right, bottom-left.
    // Error: three points of either in a line, crossed or folded corners (the quadrilateral must be
    // convex), or a coordinate that is not finite.
    static Result<Homography> fromCorners(const std::array<glm::dvec2, 4>& source, const std::array<glm::dvec2, 4>& target);

    glm::dvec2 operator()(glm::dvec2 point) const;
    Homography inverse() const;
    Homography operator*(const Homography& first) const {
        return Homography(matrix_ * first.matrix_);
    }                                                     // `first` is applied first
    const glm::dmat3& matrix() const { return matrix_; }  // column vectors: (x, y, w) = matrix * (x, y, 1)

private:
    glm::dmat3 matrix_{1.0};
};

// The corners of [0, width] x [0, height], from the top left clockwise as seen.
std::array<glm::dvec2, 4> rectangleCorners(double width, double height);

// Why four corners cannot be those of a picture (folded, crossed, degenerate), or nothing.
std::optional<std::string> whyNotConvex(const std::array<glm::dvec2, 4>& corners);

// Rotation about x, then y, then z (radians), each right-handed: R = Rz * Ry * Rx.
glm::dmat3 rotationXyz(glm::dvec3 angles);

// A rigid pose: where a device stands and which way it looks. Camera axes: x right, y down, z
// forward.
struct Pose {
    glm::dmat3 worldFromLocal{1.0};  // columns: right, down, forward in world axes
    glm::dvec3 position{0.0};        // metres

    // Looks from `position` at `target` with the picture's top towards `up`. Error: target at the
    // position, up along the view or without a length.
    static Result<Pose> lookingAt(glm::dvec3 position, glm::dvec3 target, glm::dvec3 up = {0, 1, 0});
    glm::dvec3 localFromWorld(glm::dvec3 point) const;
};

}  // namespace fantascope
