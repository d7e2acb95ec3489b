#pragma once

#include "app/calibrate/light_survey.h"

#include "media/image.h"

#include <vector>

namespace fantascope::app {

// The camera's picture as if the outputs were white all at once, linear light. `surveys`: of the
// outputs; one at least.
GreyImage litWall(const std::vector<const LightSurvey::Output*>& surveys);

// The same to look at: stored values, as bright as can be without losing the bright places.
GreyImage litWallPicture(const std::vector<const LightSurvey::Output*>& surveys);

}  // namespace fantascope::app
