#pragma once

#include "core/result.h"

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>

#include <array>

namespace fantascope::render {

// Where one output shows its canvas.
struct CanvasPlace {
    glm::ivec2 size{0};                   // pixels of the picture
    std::array<glm::dvec2, 4> corners{};  // where the canvas's corners go, in those pixels, from the canvas's top left clockwise
};

// The warp of a canvas [0, aspect] x [0, 1] into OpenGL's picture: (x, y, w) = result * (canvas x, canvas y, 1), w >= 1 all over the
// canvas. Error: corners that are not those of a picture.
Result<glm::dmat3> clipFromCanvas(double aspect, const CanvasPlace& place);

// The same of a canvas that is 0 .. 1 in both directions, whatever its aspect, as a picture of it is looked up.
Result<glm::mat3> clipFromUnitCanvas(double aspect, const CanvasPlace& place);

// How many pixels of the output the canvas is high, on average over its area.
double canvasRows(double aspect, const CanvasPlace& place);

}  // namespace fantascope::render
