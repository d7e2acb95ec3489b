#include "vision/canvas_reach.h"

#include <glm/common.hpp>

namespace fantascope::vision {
namespace {

constexpr int kEdgeSamples = 17;  // along an edge of a part
constexpr int kCell = 2;          // camera pixels
constexpr double kHoles = 1.5;    // cells; a blur in which small holes vanish and straight edges stay
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

}  // namespace

Result<PlacedCanvas> PlacedCanvas::of(const CameraModel& camera, const std::array<glm::dvec2, 4>& corners) {
    if (const auto why = whyNotConvex(corners)) return Error(*why);
    CameraModel lens = camera;
    lens.pose = Pose{};
    std::array<glm::dvec2, 4> view;
    for (std::size_t i = 0; i < 4; ++i) {
        const glm::dvec3 direction = lens.rayThrough(corners[i]).direction;
        view[i] = glm::dvec2(direction) / direction.z;
    }
    return PlacedCanvas(lens, TRY(Homography::fromCorners(rectangleCorners(1, 1), view)));
}

std::optional<glm::dvec2> PlacedCanvas::pixelFromCanvas(glm::dvec2 canvas) const {
    return lens_.pixelFromWorld(glm::dvec3(viewFromCanvas_(canvas), 1));
}

CanvasReach::CanvasReach(const CameraModel& camera, const std::vector<LitPart>& parts) : size_(camera.size) {
    for (const LitPart& part : parts) parts_.push_back({part.part, litCells(*part.map)});
}

bool CanvasReach::isLit(std::size_t part, glm::dvec2 pixel) const {
    if (!(pixel.x >= 0 && pixel.y >= 0 && pixel.x <= size_.x && pixel.y <= size_.y)) return false;
    const Image<std::uint8_t>& lit = parts_[part].lit;
    const glm::ivec2 cell = glm::min(glm::ivec2(pixel) / kCell, glm::ivec2(lit.width(), lit.height()) - 1);
    return lit.at(cell.x, cell.y) != 0;
}

std::vector<glm::dvec2> CanvasReach::litPixels(std::size_t part) const {
    const Image<std::uint8_t>& lit = parts_[part].lit;
    std::vector<glm::dvec2> pixels;
    for (int row = 0; row < lit.height(); ++row)
        for (int column = 0; column < lit.width(); ++column)
            if (lit.at(column, row) != 0) pixels.push_back((glm::dvec2(column, row) + 0.5) * double(kCell));
    return pixels;
}

std::array<glm::dvec2, 4> CanvasReach::middle() const {
    glm::dvec2 low(size_), high(0);
    for (std::size_t part = 0; part < parts_.size(); ++part)
        for (const glm::dvec2 pixel : litPixels(part)) low = glm::min(low, pixel), high = glm::max(high, pixel);
    if (!(low.x < high.x && low.y < high.y)) low = glm::dvec2(0), high = glm::dvec2(size_);
    std::array<glm::dvec2, 4> corners = rectangleCorners(1, 1);
    for (glm::dvec2& corner : corners) corner = glm::mix(low, high, 0.2 + 0.6 * corner);
    return corners;
}

bool CanvasReach::coversPart(std::size_t part,
                             const std::function<std::optional<glm::dvec2>(glm::dvec2)>& pixelFromCanvas) const {
    const auto [low, high] = parts_[part].part;
    for (int i = 0; i < kEdgeSamples; ++i) {
        const glm::dvec2 along = low + (high - low) * (double(i) / (kEdgeSamples - 1));
        for (const glm::dvec2 canvas :
             {glm::dvec2(along.x, low.y), glm::dvec2(along.x, high.y), glm::dvec2(low.x, along.y), glm::dvec2(high.x, along.y)})
            if (const auto pixel = pixelFromCanvas(canvas); !pixel || !isLit(part, *pixel)) return false;
    }
    return true;
}

bool CanvasReach::covers(const std::function<std::optional<glm::dvec2>(glm::dvec2)>& pixelFromCanvas) const {
    for (std::size_t part = 0; part < parts_.size(); ++part)
        if (!coversPart(part, pixelFromCanvas)) return false;
    return true;
}

std::vector<std::size_t> CanvasReach::uncovered(const PlacedCanvas& canvas) const {
    std::vector<std::size_t> parts;
    for (std::size_t part = 0; part < parts_.size(); ++part)
        if (!coversPart(part, [&](glm::dvec2 point) { return canvas.pixelFromCanvas(point); })) parts.push_back(part);
    return parts;
}

}  // namespace fantascope::vision
