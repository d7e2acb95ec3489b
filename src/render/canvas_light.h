#pragma once

#include "render/drawn_source.h"
#include "render/gpu/light_canvas.h"
#include "render/gpu/paint/canvas_painter.h"

namespace fantascope::render {

// Light that adds up in a picture of the canvas, shown in one colour through the output's warp.
// Thread: the context's.
class CanvasLight {
public:
    // `aspect`: the canvas's; `colour`: of as much light as 1 in that picture, linear. Errors as
    // makeDrawnSource().
    static Result<CanvasLight> create(double aspect, glm::vec3 colour, const CanvasPlace& place, DrawingTools& tools);

    void follow(const CanvasPlace& place) { painter_.follow(place); }
    // add() draws the light. `picture` is begun by this.
    template <class Add>
    void paint(gpu::LayerPicture& picture, Add add) {
        canvas_.begin();
        add();
        canvas_.end();
        show(picture);
    }

private:
    CanvasLight(glm::vec3 colour, gpu::LightCanvas canvas, gpu::CanvasPainter painter);
    void show(gpu::LayerPicture& picture);

    glm::vec3 colour_;
    gpu::LightCanvas canvas_;
    gpu::CanvasPainter painter_;
};

}  // namespace fantascope::render
