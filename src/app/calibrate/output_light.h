#pragma once

#include "app/calibrate/light_survey.h"

#include "show/site/site.h"

#include "core/warp.h"
#include "media/projection.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace fantascope::app {

// What a calibration found of an output's light settings, as they are written into the site file.
struct MeasuredLight {
    std::optional<double> gamma;      // nothing: its greys follow none
    std::optional<glm::dvec3> white;  // nothing: it is alone on its canvas, or `trouble` says why
    std::string trouble;              // why something of it is not known
};

// An output that was surveyed, and the warp that was fitted.
struct FittedOutput {
    std::size_t output = 0;
    const LightSurvey::Output* survey = nullptr;
    WarpShape warp;
};

// The light of outputs. The whites of a canvas are matched where its pictures overlap, if all of
// its outputs are among `fitted`. By output.
std::map<std::size_t, MeasuredLight> measuredLights(const show::Site& site, const std::vector<FittedOutput>& fitted);

// `light` with what was measured in place of what was set.
ProjectorLight withMeasured(ProjectorLight light, const MeasuredLight& measured);

// What was measured, for a person; what is not known is not named.
std::string wordsOf(const MeasuredLight& measured);

}  // namespace fantascope::app
