#pragma once

#include "show/site/site.h"
#include "vision/structured_light.h"

#include "core/clock.h"
#include "core/result.h"
#include "core/warp.h"
#include "media/image.h"

#include <glm/vec2.hpp>

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace fantascope::app {

// What a calibration learnt of one output and of what its light falls on.
struct OutputSurvey {
    vision::ProjectorMap map;  // which projector pixel lights each camera pixel, and how brightly
    GreyImage dark;            // by camera pixel: linear light while every output is dark; 1 is saturated
    glm::ivec2 projector{0};   // pixels of the output's picture
    double gamma = 2.2;        // of the projector: light = stored ^ gamma
    Time latency{};            // from a picture's light to its arrival from the camera
    WarpShape warp;            // that was written into the site file with it
};

// What the calibrations of a site learnt. It lies beside the site file: `site.survey/survey.yaml`
// for `site.yaml`, and pictures (docs/survey-format.md).
//
// Of each output the file keeps two records, each with the warp that was found with it. The record
// with the site's own warp counts. So site and survey belong together whichever of them was written
// last, and when the site file goes back to a version before, so does the survey.
struct Survey {
    std::map<std::string, OutputSurvey> outputs;  // by name; those that fit the site
    std::map<std::string, std::string> unfit;     // by output: why what is known of it is not used, and what to do
};

std::filesystem::path surveyFileOf(const std::filesystem::path& site);

// The survey of a site; nothing if it has none. Error: the survey, or a picture that counts, cannot
// be read: file, place, what to do.
Result<std::optional<Survey>> readSurvey(const show::Site& site);

// Keeps what was measured of some outputs beside what is known of the others, and beside what fits
// the site as it stands. A reader, or a program that starts after a power cut, finds the survey as
// it was or the new one. A survey that cannot be read is replaced. Error: names the file and the
// reason; the survey is as it was.
Result<void> writeSurvey(const show::Site& site, const std::map<std::string, OutputSurvey>& measured);

// Reads a survey file with all its pictures. Returns the names of its outputs. Error: as
// readSurvey().
Result<std::vector<std::string>> checkSurvey(const std::filesystem::path& file);

}  // namespace fantascope::app
