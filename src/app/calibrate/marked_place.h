#pragma once

#include "app/calibrate/light_survey.h"

#include "core/result.h"

#include <glm/vec2.hpp>

#include <array>
#include <vector>

namespace fantascope::app {

// The corners of a canvas by the markers on its wall (vision/corner_markers.h), in pixels of the
// camera's picture. `surveys`: of outputs whose light falls on the markers; one at least. Error:
// which markers are not seen.
Result<std::array<glm::dvec2, 4>> markedPlace(const std::vector<const LightSurvey::Output*>& surveys);

}  // namespace fantascope::app
