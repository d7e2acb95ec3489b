#include "vision/largest_place.h"

#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <cmath>

namespace fantascope::vision {
namespace {

constexpr int kCentres = 192;  // tried along the longer side of what is lit
constexpr int kHeights = 64;   // tried, down from the height of what is lit
constexpr int kRefinements = 6, kAround = 9, kHalvings = 8;

class Search {
public:
    Search(const CameraModel& camera, const std::vector<LitPart>& parts, double aspect, const Homography& uprightFromView)
        : lens_(camera), reach_(camera, parts), aspect_(aspect), viewFromUpright_(uprightFromView.inverse()) {
        lens_.pose = Pose{};
        for (std::size_t part = 0; part < reach_.size(); ++part)
            for (const glm::dvec2 pixel : reach_.litPixels(part)) {
                const glm::dvec3 ray = lens_.rayThrough(pixel).direction;
                const glm::dvec2 at = uprightFromView(glm::dvec2(ray) / ray.z);
                low_ = glm::min(low_, at), high_ = glm::max(high_, at);
            }
    }

    std::optional<std::array<glm::dvec2, 4>> best() const {
        if (!(low_.x < high_.x && low_.y < high_.y)) return std::nullopt;
        // From the largest height down, everywhere: the parts of several outputs may fit at a few
        // places only. Then around the first place that fits, finer each time.
        const double side = std::max(high_.x - low_.x, high_.y - low_.y) / kCentres, step = (high_.y - low_.y) / kHeights;
        std::optional<glm::dvec2> centre;
        double height = high_.y - low_.y;
        for (; height > 0 && !(centre = placeFor(height, side)); height -= step) continue;
        if (!centre) return std::nullopt;
        glm::dvec2 reach(side);
        for (int round = 0; round < kRefinements; ++round, reach /= 2.0) {
            const glm::dvec2 middle = *centre;
            for (int i = 0; i < kAround * kAround; ++i) {
                const glm::dvec2 at = middle + reach * (2.0 * glm::dvec2(i % kAround, i / kAround) / double(kAround - 1) - 1.0);
                if (const double here = highestAt(at, height, step); here > height) height = here, centre = at;
            }
        }
        std::array<glm::dvec2, 4> corners;
        for (std::size_t i = 0; i < 4; ++i) corners[i] = *pixelOf(placed(rectangleCorners(1, 1)[i], *centre, height));
        return corners;
    }

private:
    glm::dvec2 placed(glm::dvec2 canvas, glm::dvec2 centre, double height) const {
        return centre + (canvas - 0.5) * glm::dvec2(aspect_ * height, height);
    }
    std::optional<glm::dvec2> pixelOf(glm::dvec2 upright) const {
        return lens_.pixelFromWorld(glm::dvec3(viewFromUpright_(upright), 1));
    }
    bool fits(glm::dvec2 centre, double height) const {
        return reach_.covers([&](glm::dvec2 canvas) { return pixelOf(placed(canvas, centre, height)); });
    }
    // A centre where this height fits, of a lattice with cells of this side.
    std::optional<glm::dvec2> placeFor(double height, double side) const {
        for (double y = low_.y + side / 2; y < high_.y; y += side)
            for (double x = low_.x + side / 2; x < high_.x; x += side)
                if (fits({x, y}, height)) return glm::dvec2(x, y);
        return std::nullopt;
    }
    // The largest height that fits here, between `height` and a step more; 0: `height` does not
    // fit.
    double highestAt(glm::dvec2 centre, double height, double step) const {
        if (!fits(centre, height)) return 0;
        double low = height, high = height + step;
        for (int i = 0; i < kHalvings; ++i) {
            const double middle = (low + high) / 2;
            (fits(centre, middle) ? low : high) = middle;
        }
        return low;
    }

    CameraModel lens_;  // at the origin
    const CanvasReach reach_;
    const double aspect_;
    const Homography viewFromUpright_;
    glm::dvec2 low_{1e9}, high_{-1e9};  // what is lit
};

}  // namespace

std::optional<std::array<glm::dvec2, 4>> largestPlace(const CameraModel& camera, const std::vector<LitPart>& parts, double aspect,
                                                      const Homography& uprightFromView) {
    return Search(camera, parts, aspect, uprightFromView).best();
}

Homography uprightFromView(const CameraModel& camera, const Plane& surface) {
    constexpr double kLevel = 0.99;
    const glm::dvec3 up = std::abs(surface.normal.y) < kLevel ? glm::dvec3(0, 1, 0) : camera.pose.worldFromLocal[2];
    const glm::dvec3 down = -glm::normalize(up - surface.normal * glm::dot(up, surface.normal));
    const glm::dvec3 right = glm::cross(surface.normal, down);
    // A point of the plane is point + x right + y down; the camera sees it along R^T (that - eye).
    const glm::dmat3 localFromWorld = glm::transpose(camera.pose.worldFromLocal);
    const glm::dmat3 viewFromPlane(localFromWorld * right, localFromWorld * down,
                                   localFromWorld * (surface.point - camera.pose.position));
    return Homography(viewFromPlane).inverse();
}

}  // namespace fantascope::vision
