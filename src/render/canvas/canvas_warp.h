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

// The keystone of a canvas [0, aspect] x [0, 1] in OpenGL's picture: (x, y, w) = result * (canvas
// x, canvas y, 1), w >= 1 all over the part of the canvas that is shown.
glm::dmat3 clipFromCanvas(double aspect, const CanvasPlace& place);

// The same of the picture's own square, 0 .. 1 from its top left.
glm::dmat3 clipFromPicture(const CanvasPlace& place);

// What is seen of the canvas, in the picture's own square: all of that, unless the canvas ends
// before the picture does.
CanvasPart shownInPicture(const CanvasPlace& place);

}  // namespace fantascope::render
