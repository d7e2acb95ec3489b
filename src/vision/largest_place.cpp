#include "vision/largest_place.h"

#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <cmath>

namespace fantascope::vision {
namespace {

constexpr int kSamples = 17;  // along an edge of a part
constexpr int kCentres = 24;  // tried across and down, then around the best, finer each time
constexpr int kRefinements = 4;
constexpr int kHalvings = 12;
constexpr int kCell = 2;  // camera pixels; a cell is lit if half of its pixels are known
constexpr double kKnownShare = 0.5;

// A map's known pixels in cells, so that single unknown pixels do not count; without the cells at
// the light's edge, where a place would lose its own edge.
Image<std::uint8_t> litCells(const ProjectorMap& map) {
    Image<std::uint8_t> cells((map.at.width() + kCell - 1) / kCell, (map.at.height() + kCell - 1) / kCell);
    for (int row = 0; row < cells.height(); ++row)
        for (int column = 0; column < cells.width(); ++column) {
            int known = 0, all = 0;
            for (int y = row * kCell; y < std::min(map.at.height(), (row + 1) * kCell); ++y)
                for (int x = column * kCell; x < std::min(map.at.width(), (column + 1) * kCell); ++x, ++all)
                    known += map.isKnown(x, y) ? 1 : 0;
            cells.at(column, row) = known >= kKnownShare * all ? 1 : 0;
        }
    Image<std::uint8_t> inner(cells.width(), cells.height());
    for (int row = 1; row + 1 < cells.height(); ++row)
        for (int column = 1; column + 1 < cells.width(); ++column)
            inner.at(column, row) = cells.at(column, row) & cells.at(column - 1, row) & cells.at(column + 1, row) &
                                    cells.at(column, row - 1) & cells.at(column, row + 1);
    return inner;
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
        glm::dvec2 low = low_, high = high_, centre = (low + high) / 2.0;
        double height = 0;
        for (int round = 0; round <= kRefinements; ++round) {
            for (int i = 0; i < kCentres * kCentres; ++i) {
                const glm::dvec2 at = low + (high - low) * (glm::dvec2(i % kCentres, i / kCentres) + 0.5) / double(kCentres);
                if (const double here = highestAt(at, height); here > height) height = here, centre = at;
            }
            const glm::dvec2 step = (high - low) / double(kCentres);
            low = centre - step, high = centre + step;
        }
        if (height <= 0) return std::nullopt;
        std::array<glm::dvec2, 4> corners;
        for (std::size_t i = 0; i < 4; ++i) corners[i] = *pixelOf(placed(rectangleCorners(1, 1)[i], centre, height));
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
    double highestAt(glm::dvec2 centre, double atLeast) const {
        double low = atLeast, high = high_.y - low_.y;
        if (low >= high || (low > 0 && !fits(centre, low))) return 0;
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
