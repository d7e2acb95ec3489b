#include "core/fit.h"

#include <algorithm>
#include <cmath>

namespace fantascope {

bool isSameShape(double aspect, double other) { return std::abs(std::log(aspect / other)) < std::log1p(kSameShape); }

CanvasPart placeOnCanvas(double pictureAspect, double canvasAspect, Fit fit) {
    if (fit == Fit::Stretch || isSameShape(pictureAspect, canvasAspect)) return {};
    const double ratio = pictureAspect / canvasAspect;
    // In widths and heights of the canvas; the one that is 1 touches two edges.
    const double larger = fit == Fit::Contain ? std::max(ratio, 1.0) : std::min(ratio, 1.0);
    const glm::dvec2 size = glm::dvec2(ratio, 1) / larger;
    return {0.5 * (1.0 - size), 0.5 * (1.0 + size)};
}

}  // namespace fantascope
