#include "render/canvas_warp.h"

#include "core/geometry.h"

#include <algorithm>
#include <cmath>

namespace fantascope::render {
namespace {

// Projector pixels, y down, to OpenGL's picture, y up and -1 .. 1.
glm::dmat3 clipFromProjector(glm::ivec2 size) { return {2.0 / size.x, 0, 0, 0, -2.0 / size.y, 0, -1, 1, 1}; }

}  // namespace

Result<glm::dmat3> clipFromCanvas(double aspect, const CanvasPlace& place) {
    const std::array<glm::dvec2, 4> canvas = rectangleCorners(aspect, 1);
    const Homography projectorFromCanvas = TRY(Homography::fromCorners(canvas, place.corners));
    const glm::dmat3 warp = clipFromProjector(place.size) * projectorFromCanvas.matrix();
    // A projective map is free in scale: the least w of the canvas becomes 1, so that depths of 0 .. 1 stay in front of the far
    // plane.
    double least = INFINITY;
    for (const glm::dvec2 corner : canvas) least = std::min(least, (warp * glm::dvec3(corner, 1)).z);
    return warp / least;
}

Result<glm::mat3> clipFromUnitCanvas(double aspect, const CanvasPlace& place) {
    const glm::dmat3 canvasFromUnit(aspect, 0, 0, 0, 1, 0, 0, 0, 1);
    return glm::mat3(TRY(clipFromCanvas(aspect, place)) * canvasFromUnit);
}

double canvasRows(double aspect, const CanvasPlace& place) {
    double area = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        const glm::dvec2 a = place.corners[i], b = place.corners[(i + 1) % 4];
        area += (a.x * b.y - b.x * a.y) / 2;
    }
    return std::sqrt(std::abs(area) / aspect);
}

}  // namespace fantascope::render
