#pragma once

#include "core/warp.h"

namespace fantascope {

// How a picture fits a canvas of another shape.
enum class Fit {
    Contain,  // all of it is visible, as large as possible; the canvas stays dark beside it
    Cover,    // the canvas is full; what exceeds its edges is cut off
    Stretch   // edge to edge: circles become ellipses
};

// Shapes that differ by less count as one: nobody sees the stretching, but everybody would see a
// dark edge.
constexpr double kSameShape = 0.02;

// Whether two shapes (width / height) count as one.
bool isSameShape(double aspect, double other);

// The picture's place on the canvas, centred; it exceeds the canvas if it is cut off. Aspects are
// width / height, > 0. The whole canvas if stretched, or if both have the same shape.
CanvasPart placeOnCanvas(double pictureAspect, double canvasAspect, Fit fit);

}  // namespace fantascope
