#include "vision/camera_model.h"

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace fantascope::vision {
namespace {

// A distorted radius, in focal lengths, and the distortion's slope there.
struct Distorted {
    double radius, slope;
};

Distorted distorted(double r, double k1, double k2) {
    const double r2 = r * r;
    return {r * (1 + r2 * (k1 + r2 * k2)), 1 + r2 * (3 * k1 + r2 * 5 * k2)};
}

// The radius beyond which the picture would fold over itself: the smallest root of the slope 1 + 3
// k1 r^2 + 5 k2 r^4.
double foldRadius(double k1, double k2) {
    constexpr double kNever = std::numeric_limits<double>::infinity();
    if (k2 == 0) return k1 < 0 ? std::sqrt(-1 / (3 * k1)) : kNever;
    const double discriminant = 9 * k1 * k1 - 20 * k2;
    if (discriminant < 0) return kNever;
    double nearest = kNever;
    for (const double sign : {-1.0, 1.0}) {
        const double r2 = (-3 * k1 + sign * std::sqrt(discriminant)) / (10 * k2);
        if (r2 > 0) nearest = std::min(nearest, std::sqrt(r2));
    }
    return nearest;
}

// Newton's iteration for the radius. Below the fold the map rises. From the distorted radius (kept
// below the fold) it converges for every distortion that fromFieldOfView() accepts.
double undistorted(double seen, double k1, double k2) {
    const double fold = foldRadius(k1, k2);
    double r = std::min(seen, 0.95 * fold);
    for (int iteration = 0; iteration < 50; ++iteration) {
        const Distorted at = distorted(r, k1, k2);
        const double step = (at.radius - seen) / at.slope;
        r = std::clamp(r - step, 0.0, fold);
        if (std::abs(step) < 1e-13) break;
    }
    return r;
}

}  // namespace

std::optional<glm::dvec3> Plane::hitBy(const Ray& ray) const {
    const double towards = -glm::dot(ray.direction, normal), height = glm::dot(ray.origin - point, normal);
    if (towards < 1e-9 || height <= 0) return std::nullopt;
    return ray.origin + ray.direction * (height / towards);
}

Result<CameraModel> CameraModel::fromFieldOfView(const Pose& pose, glm::ivec2 size, double fieldOfView, double k1, double k2,
                                                 std::optional<glm::dvec2> centre) {
    const glm::dvec2 middle = glm::dvec2(size) / 2.0, axis = centre.value_or(middle);
    const double focal = middle.x / std::tan(fieldOfView / 2);
    const double fold = foldRadius(k1, k2), corner = glm::length(middle + glm::abs(axis - middle)) / focal;
    if (std::isfinite(fold) && distorted(fold, k1, k2).radius <= corner)
        return Error(fmt::format(
            "distortion k1 = {}, k2 = {} folds the picture over at {:.0f} % of the way to its corners; calibrate again, "
            "or give a smaller field of view",
            k1, k2, 100 * distorted(fold, k1, k2).radius / corner));
    return CameraModel{pose, size, focal, axis, k1, k2};
}

double CameraModel::fieldOfView() const { return 2 * std::atan(size.x / 2.0 / focal); }

CameraModel CameraModel::fromThrowRatio(const Pose& pose, glm::ivec2 size, double throwRatio, glm::dvec2 lensShift) {
    const glm::dvec2 pixels = size;
    return {pose, size, throwRatio * pixels.x, {pixels.x * (0.5 - lensShift.x), pixels.y * (0.5 + lensShift.y)}, 0, 0};
}

std::optional<glm::dvec2> CameraModel::pixelFromWorld(glm::dvec3 point) const {
    const glm::dvec3 local = pose.localFromWorld(point);
    if (local.z <= 0) return std::nullopt;
    const glm::dvec2 ideal = glm::dvec2(local) / local.z;
    const double r = glm::length(ideal);
    if (r > foldRadius(k1, k2)) return std::nullopt;
    const double stretch = r > 0 ? distorted(r, k1, k2).radius / r : 1;
    return centre + focal * stretch * ideal;
}

double CameraModel::pixelsPerArea(glm::dvec3 point, glm::dvec3 normal) const {
    // A plane at `depth` that faces the camera squarely has (focal / depth)^2 pixels per area
    // anywhere in the picture. This surface is slanted to the ray, and the ray to the axis: cos(to
    // normal) / cos(to axis), with the distance cancelled.
    const glm::dvec3 toEye = pose.position - point;
    const double depth = -glm::dot(toEye, pose.worldFromLocal[2]);
    return focal * focal * glm::dot(normal, toEye) / (depth * depth * depth);
}

bool CameraModel::inPicture(glm::dvec2 pixel) const {
    return pixel.x >= 0 && pixel.y >= 0 && pixel.x <= size.x && pixel.y <= size.y;
}

Ray CameraModel::rayThrough(glm::dvec2 pixel) const {
    const glm::dvec2 seen = (pixel - centre) / focal;
    const double r = glm::length(seen);
    const glm::dvec2 ideal = r > 0 ? seen * (undistorted(r, k1, k2) / r) : seen;
    return {pose.position, pose.worldFromLocal * glm::normalize(glm::dvec3(ideal, 1.0))};
}

Result<std::array<glm::dvec2, 4>> rectifyingCorners(const CameraModel& projector, const std::array<glm::dvec3, 4>& corners) {
    std::array<glm::dvec2, 4> pixels;
    for (std::size_t i = 0; i < 4; ++i) {
        const auto pixel = projector.pixelFromWorld(corners[i]);
        if (!pixel || !projector.inPicture(*pixel))
            return Error(fmt::format(
                "corner {} lies outside the projector's picture{}; move or turn the projector, or choose a smaller quadrilateral",
                i + 1, pixel ? fmt::format(" (at pixel {:.0f}, {:.0f})", pixel->x, pixel->y) : ""));
        pixels[i] = *pixel;
    }
    return pixels;
}

}  // namespace fantascope::vision
