#pragma once

#include "render/drawn_source.h"
#include "render/gpu/light_canvas.h"
#include "render/gpu/paint/canvas_painter.h"

namespace fantascope::render {

// Light that is accumulated in a picture of the canvas and then shown in one colour through the
// output's warp. Thread: the context's.
class CanvasLight {
public:
    // `aspect`: of the canvas. `colour`: linear light that a value of 1 in that picture stands for.
    // Errors as makeDrawnSource().
    static Result<CanvasLight> create(double aspect, glm::vec3 colour, const CanvasPlace& place, DrawingTools& tools);

    void follow(const CanvasPlace& place) { painter_.follow(place); }
    // Begins `picture`, and paints into it the light that add() draws.
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
