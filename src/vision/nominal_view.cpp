#include "vision/nominal_view.h"

#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <utility>

namespace fantascope::vision {
namespace {

std::optional<glm::dvec3> surfaceAt(const NominalView& view, glm::dvec2 canvas) {
    return view.surface.hitBy(view.projector.rayThrough(view.warp.projectorFromCanvas(canvas)));
}

std::optional<glm::dvec2> pixelAt(const NominalView& view, const std::optional<glm::dvec3>& point) {
    const auto pixel = point ? view.camera.pixelFromWorld(*point) : std::nullopt;
    return pixel && view.camera.inPicture(*pixel) ? pixel : std::nullopt;
}

}  // namespace

std::optional<glm::dvec2> NominalView::pixelOf(glm::dvec2 canvas) const { return pixelAt(*this, surfaceAt(*this, canvas)); }

std::vector<CanvasCell> cellsInSight(const NominalView& view, glm::ivec2 grid, int places) {
    const CanvasPart part = view.warp.shown();
    const auto whole = static_cast<std::size_t>(places) * static_cast<std::size_t>(places);
    std::vector<CanvasCell> cells;
    double strongest = 0;
    for (int row = 0; row < grid.y; ++row)
        for (int column = 0; column < grid.x; ++column) {
            CanvasCell cell{column, row, {}, 0};
            for (int i = 0; i < places * places; ++i) {
                const glm::dvec2 within((i % places + 0.5) / places, (i / places + 0.5) / places);
                const glm::dvec2 canvas = (glm::dvec2(column, row) + within) / glm::dvec2(grid);
                if (glm::any(glm::lessThan(canvas, part.low)) || glm::any(glm::greaterThan(canvas, part.high))) break;
                const auto point = surfaceAt(view, canvas);
                const auto pixel = pixelAt(view, point);
                if (!pixel) break;
                cell.places.emplace_back(*pixel);
                cell.gain += view.projector.pixelsPerArea(*point, view.surface.normal);
            }
            if (cell.places.size() < whole) continue;
            strongest = std::max(strongest, cell.gain);
            cells.push_back(std::move(cell));
        }
    for (CanvasCell& cell : cells) cell.gain /= strongest;
    return cells;
}

glm::dvec3 linearAt(const CameraLight& light, const RgbaImage& frame, glm::vec2 pixel) {
    const auto at = [&](int x, int y) { return light.at(frame, x, y); };
    const glm::vec2 corner = glm::floor(pixel - 0.5f), share = pixel - 0.5f - corner;
    const int x = static_cast<int>(corner.x), y = static_cast<int>(corner.y);
    return glm::mix(glm::mix(at(x, y), at(x + 1, y), share.x), glm::mix(at(x, y + 1), at(x + 1, y + 1), share.x), share.y);
}

glm::dvec3 linearOf(const CameraLight& light, const RgbaImage& frame, const CanvasCell& cell) {
    glm::dvec3 sum(0);
    for (const glm::vec2 place : cell.places) sum += linearAt(light, frame, place);
    return sum / static_cast<double>(cell.places.size());
}

}  // namespace fantascope::vision
