#include "app/calibrate/marked_place.h"

#include "app/calibrate/lit_wall.h"

#include "vision/corner_markers.h"

namespace fantascope::app {

Result<std::array<glm::dvec2, 4>> markedPlace(const std::vector<const LightSurvey::Output*>& surveys) {
    return vision::findCornerMarkers(litWall(surveys));
}

}  // namespace fantascope::app
