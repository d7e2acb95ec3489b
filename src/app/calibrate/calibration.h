#pragma once

#include "app/calibrate/light_survey.h"
#include "app/calibrate/output_light.h"
#include "app/calibrate/wanted_file.h"

#include "show/site/site.h"
#include "vision/warp_fit.h"

#include "core/result.h"

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace fantascope::app {

// One output's calibration.
struct OutputCalibration {
    std::size_t output = 0;
    std::string trouble;                             // why it has no fit, or why the fit is not good enough; empty: it is good
    std::string note;                                // what a person should look at although it is good; may be empty
    std::optional<std::array<glm::dvec2, 4>> place;  // of its canvas: the corners, as in a wanted file
    std::optional<vision::WarpFit> fit;
    std::optional<LightSurvey::Output> survey;  // none: not measured
    MeasuredLight light;
    bool written = false;

    bool isGood() const { return fit && trouble.empty(); }
};

// The worst residual, projector pixels, with which a calibration counts as good.
constexpr double kGoodRms = 1.0;
// The farthest, projector pixels, that something may seem to have moved while outputs were
// measured.
constexpr double kMostMoved = 0.5;

// Finds the warps and the light of some outputs of a site. An output that fails does not stop the
// others. `wanted`: where canvases are to stand; without markers or a person, an output that is not
// in it gets the largest upright place that its canvas's outputs light, for which all of these must
// be among `outputs`.
// Error: the camera gives no pictures, or sees no output; the person who was asked for a place gave
// none.
Result<std::vector<OutputCalibration>> calibrate(LightSurvey& survey, const show::Site& site,
                                                 const std::vector<std::size_t>& outputs, const Wanted& wanted);

// Writes the good warps with their light into the site file, keeps the version before as
// FILE.previous, and keeps what was seen as the site's survey (survey_file.h). `latency`: from a
// picture's light to its arrival from the camera. Error: a file cannot be changed; the site file
// stays as it was.
Result<void> writeCalibration(const show::Site& site, std::vector<OutputCalibration>& calibrations, Time latency);

}  // namespace fantascope::app
