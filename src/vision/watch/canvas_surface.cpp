#include "vision/watch/canvas_surface.h"

namespace fantascope::vision {

GreyImage CanvasSurface::light(const std::map<std::size_t, WallChange>& changes) const {
    GreyImage sum(parts[0].light.width(), parts[0].light.height());
    for (const Part& part : parts) {
        const auto found = changes.find(part.output);
        for (std::size_t i = 0; i < sum.pixels().size(); ++i) {
            const float light = part.light.pixels()[i];
            if (light <= 0) continue;
            const double factor = found != changes.end() ? found->second.at(glm::dvec2(part.pixel.pixels()[i])) : 1;
            sum.pixels()[i] += static_cast<float>(light * factor);
        }
    }
    return sum;
}

}  // namespace fantascope::vision
