#include "vision/largest_place.h"

#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <cmath>

namespace fantascope::vision {
namespace {

constexpr int kSamples = 17;   // along an edge of a part
constexpr int kCentres = 192;  // tried along the longer side of what is lit
constexpr int kHeights = 64;   // tried, down from the height of what is lit
constexpr int kRefinements = 6, kAround = 9, kHalvings = 8;
constexpr int kCell = 2;        // camera pixels
constexpr double kHoles = 1.5;  // cells; a blur in which small holes vanish and straight edges stay
constexpr float kKnownShare = 0.5f;

// What is lit, in cells: those around which most pixels are known, so that small holes do not
// count. Without the cells at the light's edge, where a place would lose its own edge.
Image<std::uint8_t> litCells(const ProjectorMap& map) {
    const int columns = (map.at.width() + kCell - 1) / kCell, rows = (map.at.height() + kCell - 1) / kCell;
    GreyImage known(columns, rows);
    for (int y = 0; y < map.at.height(); ++y)
        for (int x = 0; x < map.at.width(); ++x) known.at(x / kCell, y / kCell) += map.isKnown(x, y) ? 1.0f / (kCell * kCell) : 0;
    known = blurred(known, kHoles);
    const auto isLit = [&](int column, int row) { return known.at(column, row) > kKnownShare; };
    Image<std::uint8_t> cells(columns, rows);
    for (int row = 1; row + 1 < rows; ++row)
        for (int column = 1; column + 1 < columns; ++column)
            cells.at(column, row) = isLit(column, row) && isLit(column - 1, row) && isLit(column + 1, row) &&
                                    isLit(column, row - 1) && isLit(column, row + 1);
    return cells;
}

class Search {
public:
    Search(const CameraModel& camera, const std::vector<LitPart>& parts, double aspect, const Homography& uprightFromView)
        : lens_(camera), aspect_(aspect), viewFromUpright_(uprightFromView.inverse()) {
        lens_.pose = Pose{};
        for (const LitPart& part : parts) parts_.push_back({part.part, litCells(*part.map)});
        for (const Part& part : parts_)
            for (int row = 0; row < part.lit.height(); ++row)
                for (int column = 0; column < part.lit.width(); ++column) {
                    if (part.lit.at(column, row) == 0) continue;
                    const glm::dvec3 ray = lens_.rayThrough((glm::dvec2(column, row) + 0.5) * double(kCell)).direction;
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
    struct Part {
        CanvasPart part;
        Image<std::uint8_t> lit;
    };
    glm::dvec2 placed(glm::dvec2 canvas, glm::dvec2 centre, double height) const {
        return centre + (canvas - 0.5) * glm::dvec2(aspect_ * height, height);
    }
    std::optional<glm::dvec2> pixelOf(glm::dvec2 upright) const {
        return lens_.pixelFromWorld(glm::dvec3(viewFromUpright_(upright), 1));
    }
    bool isLit(const Part& part, glm::dvec2 upright) const {
        const auto pixel = pixelOf(upright);
        if (!pixel || !lens_.inPicture(*pixel)) return false;
        const glm::ivec2 cell = glm::min(glm::ivec2(*pixel) / kCell, glm::ivec2(part.lit.width(), part.lit.height()) - 1);
        return part.lit.at(cell.x, cell.y) != 0;
    }
    // The parts' edges decide: what they enclose may have holes, such as things before the wall.
    bool fits(glm::dvec2 centre, double height) const {
        for (const Part& part : parts_)
            for (int i = 0; i < kSamples; ++i) {
                const glm::dvec2 along = part.part.low + (part.part.high - part.part.low) * (double(i) / (kSamples - 1));
                for (const glm::dvec2 canvas : {glm::dvec2(along.x, part.part.low.y), glm::dvec2(along.x, part.part.high.y),
                                                glm::dvec2(part.part.low.x, along.y), glm::dvec2(part.part.high.x, along.y)})
                    if (!isLit(part, placed(canvas, centre, height))) return false;
            }
        return true;
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
    const double aspect_;
    const Homography viewFromUpright_;
    std::vector<Part> parts_;
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
