#pragma once

#include "core/warp.h"

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>

namespace fantascope::render {

// Where one output shows its canvas.
struct CanvasPlace {
    glm::ivec2 size{0};  // pixels of the picture
    Warp warp = Warp::straight({1, 1});
};

// The keystone from a canvas [0, aspect] x [0, 1] to clip space: (x, y, w) = result * (canvas x,
// canvas y, 1), with w >= 1 on the whole part of the canvas that is shown.
glm::dmat3 clipFromCanvas(double aspect, const CanvasPlace& place);

// The same from the picture's unit square, 0 .. 1 from its top left.
glm::dmat3 clipFromPicture(const CanvasPlace& place);

// The part of the picture's unit square that shows canvas: all of it, unless the canvas ends inside
// the picture.
CanvasPart shownInPicture(const CanvasPlace& place);

}  // namespace fantascope::render
