#include "render/canvas_light.h"

#include <array>
#include <cmath>
#include <utility>

namespace fantascope::render {

Result<CanvasLight> CanvasLight::create(double aspect, glm::vec3 colour, const CanvasPlace& place, DrawingTools& tools) {
    const double rows = std::ceil(place.warp.canvasRows(aspect));
    auto canvas = TRY(gpu::LightCanvas::create(glm::ivec2(std::ceil(aspect * rows), rows)));
    auto painter = TRY(gpu::CanvasPainter::create(1, 0, tools.bend, tools.programs));
    painter.follow(place);
    return CanvasLight(colour, std::move(canvas), std::move(painter));
}

CanvasLight::CanvasLight(glm::vec3 colour, gpu::LightCanvas canvas, gpu::CanvasPainter painter)
    : colour_(colour), canvas_(std::move(canvas)), painter_(std::move(painter)) {}

void CanvasLight::show(gpu::LayerPicture& picture) {
    picture.begin();
    const std::array pictures = {gpu::CanvasPainter::Picture{.texture = canvas_.texture()}};
    painter_.paint(pictures, nullptr, glm::vec3(0), colour_);
}

}  // namespace fantascope::render
