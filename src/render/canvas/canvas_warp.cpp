#include "render/canvas/canvas_warp.h"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>

namespace fantascope::render {
namespace {

// From projector pixels, y down, to clip space, y up and -1 .. 1.
glm::dmat3 clipFromProjector(glm::ivec2 size) { return {2.0 / size.x, 0, 0, 0, -2.0 / size.y, 0, -1, 1, 1}; }

}  // namespace

glm::dmat3 clipFromPicture(const CanvasPlace& place) {
    const glm::dmat3 warp = clipFromProjector(place.size) * place.warp.keystoneFromPicture().matrix();
    // The scale of a homography is free. It is set so that the minimum w in the picture is 1, which
    // keeps depths of 0 .. 1 in front of the far plane.
    double minW = INFINITY;
    for (const glm::dvec2 corner : rectangleCorners(1, 1)) minW = std::min(minW, (warp * glm::dvec3(corner, 1)).z);
    return warp / minW;
}

CanvasPart shownInPicture(const CanvasPlace& place) {
    const CanvasPart shown = place.warp.shown();
    if (shown == place.warp.shape().part) return {};
    const Homography& pictureFromCanvas = place.warp.pictureFromCanvas();
    const glm::dvec2 a = pictureFromCanvas(shown.low), b = pictureFromCanvas(shown.high);
    return {glm::min(a, b), glm::max(a, b)};
}

glm::dmat3 clipFromCanvas(double aspect, const CanvasPlace& place) {
    const glm::dmat3 wholeFromCanvas(1 / aspect, 0, 0, 0, 1, 0, 0, 0, 1);
    return clipFromPicture(place) * place.warp.pictureFromCanvas().matrix() * wholeFromCanvas;
}

}  // namespace fantascope::render
