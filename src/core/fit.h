#pragma once

#include "core/warp.h"

namespace fantascope {

// How a picture lies on a canvas of another shape.
enum class Fit {
    Contain,  // all of it is seen, as large as there is room for; the canvas stays dark beside it
    Cover,    // the canvas is full; what hangs over its edges is cut off
    Stretch   // edge to edge: circles become ellipses
};

// Shapes that differ by less are one: nobody sees the stretching, but everybody would see a dark
// edge.
constexpr double kSameShape = 0.02;

// Whether two shapes (width / height) are one.
bool isSameShape(double aspect, double other);

// Where on the canvas the picture lies, in the middle; beyond the canvas where it is cut off.
// Aspects are width / height, > 0. Stretched, or of the canvas's own shape: the whole canvas.
CanvasPart placeOnCanvas(double pictureAspect, double canvasAspect, Fit fit);

}  // namespace fantascope
