#include "app/site/canvas_view.h"

#include <glm/geometric.hpp>

#include <array>

namespace fantascope::app {

std::optional<glm::dvec2> CanvasView::sizeOnSurface() const {
    if (!surface) return std::nullopt;
    const CanvasPart& part = warp.shape().part;
    const std::array<glm::dvec2, 4> canvas = {{part.low, {part.high.x, part.low.y}, part.high, {part.low.x, part.high.y}}};
    std::array<glm::dvec3, 4> points;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const auto point = surface->hitBy(projector.rayThrough(warp.projectorFromCanvas(canvas[i])));
        if (!point) return std::nullopt;
        points[i] = *point;
    }
    return glm::dvec2(glm::distance(points[0], points[1]) + glm::distance(points[3], points[2]),
                      glm::distance(points[0], points[3]) + glm::distance(points[1], points[2])) /
           2.0 / (part.high - part.low);
}

}  // namespace fantascope::app
