#include "app/calibrate/marked_place.h"

#include "vision/corner_markers.h"

#include <cstddef>

namespace fantascope::app {

Result<std::array<glm::dvec2, 4>> markedPlace(const std::vector<const LightSurvey::Output*>& surveys) {
    // As if all outputs were white at once.
    GreyImage light = surveys.at(0)->dark;
    for (const LightSurvey::Output* const survey : surveys)
        for (std::size_t i = 0; i < light.pixels().size(); ++i)
            light.pixels()[i] += survey->full.pixels()[i] - survey->dark.pixels()[i];
    return vision::findCornerMarkers(light);
}

}  // namespace fantascope::app
