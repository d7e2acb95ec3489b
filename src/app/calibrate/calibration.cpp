#include "app/calibrate/calibration.h"

#include "app/calibrate/lit_wall.h"
#include "app/calibrate/marked_place.h"
#include "app/calibrate/plan_check.h"
#include "app/site/site_models.h"
#include "app/site/survey_file.h"

#include "show/site/projection_changes.h"
#include "vision/largest_place.h"

#include "core/config/config_edit.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <utility>

namespace fantascope::app {
namespace {

using Corners = std::array<glm::dvec2, 4>;

using Surveys = std::map<std::size_t, const LightSurvey::Output*>;  // by output

// The outputs of a canvas that were measured.
std::vector<std::size_t> measuredOn(const show::Site& site, const std::string& canvas, const Surveys& surveys) {
    std::vector<std::size_t> outputs = site.outputsOn(canvas);
    std::erase_if(outputs, [&](std::size_t output) { return !surveys.contains(output); });
    return outputs;
}

std::vector<vision::LitPart> partsOf(const show::Site& site, const std::string& canvas, const Surveys& surveys) {
    std::vector<vision::LitPart> parts;
    for (const std::size_t output : measuredOn(site, canvas, surveys))
        parts.push_back({site.outputs[output].projection.warp.shape().part, &surveys.at(output)->map});
    return parts;
}

// The largest upright place of a canvas in the light of those of its outputs that were measured.
std::optional<Corners> largestPlaceIn(const show::Site& site, const std::string& canvas, const vision::CameraModel& camera,
                                      const Surveys& surveys) {
    const show::Output& first = site.outputs[site.outputsOn(canvas)[0]];
    const double known = first.projection.canvasAspect;
    const double aspect = known > 0 ? known : canvasAspectInPixels(site, canvas);
    Homography upright;
    if (first.surface) upright = vision::uprightFromView(camera, {first.surface->point, first.surface->normal});
    return vision::largestPlace(camera, partsOf(site, canvas, surveys), aspect, upright);
}

// The same. Error: not all of its outputs were measured, or it finds no place in their light.
Result<Corners> largestPlaceOf(const show::Site& site, const std::string& canvas, const vision::CameraModel& camera,
                               const Surveys& surveys) {
    for (const std::size_t output : site.outputsOn(canvas))
        if (!surveys.contains(output))
            return Error(
                fmt::format("it shares the canvas '{}' with '{}', which was not measured; calibrate both, or say with "
                            "--wanted where the canvas is to stand",
                            canvas, site.outputs[output].name));
    const auto place = largestPlaceIn(site, canvas, camera, surveys);
    if (!place) return Error("no place for its canvas is lit; its outputs' pictures must touch or overlap where their parts do");
    return *place;
}

// The place of a canvas by its markers, in the light of those of its outputs that were measured.
Result<Corners> markedPlaceOf(const show::Site& site, const std::string& canvas, const Surveys& surveys) {
    std::vector<const LightSurvey::Output*> light;
    for (const std::size_t output : measuredOn(site, canvas, surveys)) light.push_back(surveys.at(output));
    return markedPlace(light);
}

// A canvas whose place a person is to choose.
OpenPlace openPlaceOf(const show::Site& site, const std::string& canvas, const vision::CameraModel& camera,
                      const Surveys& surveys) {
    std::vector<const LightSurvey::Output*> light;
    std::vector<std::string> names;
    for (const std::size_t output : measuredOn(site, canvas, surveys)) {
        light.push_back(surveys.at(output));
        names.push_back(site.outputs[output].name);
    }
    OpenPlace place{canvas, names, camera, litWallPicture(light), {camera, partsOf(site, canvas, surveys)}, {}};
    // Where no place is in reach of all, there is one to begin with, and the person sees why.
    place.corners = largestPlaceIn(site, canvas, camera, surveys).value_or(place.reach.middle());
    return place;
}

// The places of the canvases of measured outputs that are not given. Error: a person was to say and
// did not.
Result<std::map<std::string, Result<Corners>>> placesOf(const show::Site& site, const vision::CameraModel& camera,
                                                        const Surveys& surveys, const Wanted& wanted) {
    std::map<std::string, Result<Corners>> places;
    std::vector<OpenPlace> open;
    for (const auto& [index, survey] : surveys) {
        const show::Output& output = site.outputs[index];
        if (wanted.corners.contains(output.name) || places.contains(output.canvas)) continue;
        if (wanted.markers)
            places.emplace(output.canvas, markedPlaceOf(site, output.canvas, surveys));
        else if (!wanted.choose)
            places.emplace(output.canvas, largestPlaceOf(site, output.canvas, camera, surveys));
        else if (std::ranges::find(open, output.canvas, &OpenPlace::canvas) == open.end())
            open.push_back(openPlaceOf(site, output.canvas, camera, surveys));
    }
    if (open.empty()) return places;
    std::vector<std::string> canvases;
    for (const OpenPlace& place : open) canvases.push_back(place.canvas);
    const std::vector<Corners> chosen = TRY(wanted.choose(std::move(open)));
    for (std::size_t i = 0; i < canvases.size(); ++i) places.emplace(canvases[i], chosen.at(i));
    return places;
}

// Fits one output's warp, and says in `trouble` why that is not good enough.
void fit(OutputCalibration& calibration, const LightSurvey::Output& survey, const vision::CameraModel& camera,
         const Result<Corners>& wanted, const WarpShape& now) {
    if (!wanted) {
        calibration.trouble = wanted.error().message();
        return;
    }
    calibration.place = *wanted;
    const auto fitted = vision::fitWarp(vision::sharedPoints(survey.map), {camera, *wanted}, now);
    if (!fitted) {
        calibration.trouble = fitted.error().message();
        return;
    }
    calibration.fit = *fitted;
    if (fitted->rms > kGoodRms)
        calibration.trouble = fmt::format(
            "the warp misses what was measured by {:.2f} px, {:.1f} are allowed; the surface may be too "
            "rough, or something moved all the time",
            fitted->rms, kGoodRms);
}

// Whether the camera is the right way up. It sees the wall consistently if it is not, so that only
// what the site file says can tell; where the place was given by hand, it does not matter.
Result<void> checkUpright(OutputCalibration& calibration, const show::Site& site, const LightSurvey::Output& survey) {
    const auto upsideDown = TRY(isUpsideDown(site, calibration.output, survey.map));
    if (upsideDown == true)
        return Error(
            "the camera sees its picture upside down, against what the site file says of projector and camera; turn the "
            "camera the right way up, or write 'turn: 180' if the projector hangs upside down, and calibrate again. "
            "--wanted says where a picture is to stand whichever way up they are");
    const WarpShape& before = site.outputs[calibration.output].projection.warp.shape();
    if (!upsideDown && calibration.fit && isHalfTurned(calibration.fit->shape, before))
        calibration.note +=
            std::string(calibration.note.empty() ? "" : "; ") +
            "turned by half a turn from before; if it stands upside down on the wall, turn the camera the right way up, and "
            "calibrate again";
    return {};
}

// Looks whether something has moved since the outputs were measured. If so, what the camera saw
// before and after does not fit together, and all outputs of that canvas are refused and dropped
// from `surveys`.
void dropMoved(LightSurvey& survey, const show::Site& site, std::vector<OutputCalibration>& calibrations, Surveys& surveys) {
    std::map<std::string, std::string> moved;  // by canvas: what is to be said
    for (OutputCalibration& calibration : calibrations) {
        const auto found = surveys.find(calibration.output);
        if (found == surveys.end()) continue;
        const show::Output& output = site.outputs[calibration.output];
        const auto distance = survey.movedSince(calibration.output, *found->second, kMostMoved);
        if (!distance)
            calibration.note =
                fmt::format("whether something has moved since it was measured is not known: {}", distance.error().message());
        else if (*distance > kMostMoved)
            moved[output.canvas] = fmt::format(
                "the light of '{}' has moved by {:.1f} px since it was measured; see that camera, projectors and surface "
                "stand still, and calibrate again",
                output.name, *distance);
    }
    for (OutputCalibration& calibration : calibrations) {
        const auto why = moved.find(site.outputs[calibration.output].canvas);
        if (why != moved.end() && surveys.erase(calibration.output) > 0) calibration.trouble = why->second;
    }
}

// What is kept of the good calibrations. `text`: of the site file with their warps, which are
// compared as they will be read.
Result<std::map<std::string, OutputSurvey>> surveyOf(const show::Site& site, const std::vector<OutputCalibration>& calibrations,
                                                     Time latency, const std::string& text) {
    const show::Site written = TRY(show::parseSite(text, site.file));
    std::map<std::string, OutputSurvey> surveys;
    for (const OutputCalibration& calibration : calibrations) {
        if (!calibration.isGood()) continue;
        const std::string& name = site.outputs[calibration.output].name;
        const show::Output& output = written.outputs[TRY(outputNamed(written, name))];
        const LightSurvey::Output& seen = *calibration.survey;
        surveys[name] = {seen.map, seen.dark, output.size(), seen.gamma, latency, output.projection.warp.shape()};
    }
    return surveys;
}

}  // namespace

Result<std::vector<OutputCalibration>> calibrate(LightSurvey& survey, const show::Site& site,
                                                 const std::vector<std::size_t>& outputs, const Wanted& wanted) {
    const vision::CameraModel camera = TRY(cameraOf(site));
    TRY(survey.begin(outputs));
    std::vector<OutputCalibration> calibrations;
    Surveys surveys;
    calibrations.reserve(outputs.size());  // surveys points into it
    for (const std::size_t output : outputs) {
        OutputCalibration& calibration = calibrations.emplace_back();
        calibration.output = output;
        auto found = survey.survey(output);
        if (!found) {
            calibration.trouble = found.error().message();
            continue;
        }
        calibration.survey = std::move(*found);
        surveys[output] = &*calibration.survey;
    }
    dropMoved(survey, site, calibrations, surveys);
    const auto places = TRY(placesOf(site, camera, surveys, wanted));
    for (OutputCalibration& calibration : calibrations) {
        const auto found = surveys.find(calibration.output);
        if (found == surveys.end()) continue;
        const show::Output& output = site.outputs[calibration.output];
        const auto given = wanted.corners.find(output.name);
        fit(calibration, *found->second, camera,
            given != wanted.corners.end() ? Result<Corners>(given->second) : places.at(output.canvas),
            output.projection.warp.shape());
        // Somebody has said which way up.
        if (given != wanted.corners.end() || wanted.markers || wanted.choose) continue;
        if (const auto upright = checkUpright(calibration, site, *found->second); !upright)
            calibration.trouble = upright.error().message();
    }
    std::vector<FittedOutput> fitted;
    for (const OutputCalibration& calibration : calibrations)
        if (calibration.isGood()) fitted.push_back({calibration.output, &*calibration.survey, calibration.fit->shape});
    for (const auto& [output, light] : measuredLights(site, fitted))
        std::ranges::find(calibrations, output, &OutputCalibration::output)->light = light;
    return calibrations;
}

Result<void> writeCalibration(const show::Site& site, std::vector<OutputCalibration>& calibrations, Time latency) {
    ConfigDocument document = TRY(ConfigDocument::load(site.file));
    for (const OutputCalibration& calibration : calibrations) {
        if (!calibration.isGood()) continue;
        const Projection& then = site.outputs[calibration.output].projection;
        Projection now = then;
        now.warp = TRY(Warp::of(calibration.fit->shape));
        now.light = withMeasured(now.light, calibration.light);
        TRY(applyChanges(document, site, show::projectionChanges(then, now, calibration.output)));
    }
    // The survey comes first: whichever file is written last, the survey has a record for the warps
    // that stand in the site file.
    TRY(writeSurvey(site, TRY(surveyOf(site, calibrations, latency, document.text()))));
    TRY(document.save());
    for (OutputCalibration& calibration : calibrations) calibration.written = calibration.isGood();
    return {};
}

}  // namespace fantascope::app
