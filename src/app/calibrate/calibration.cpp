#include "app/calibrate/calibration.h"

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

// The largest upright place of a canvas. Error: not all of its outputs were measured, or it finds
// no place in their light.
Result<Corners> largestPlaceOf(const show::Site& site, const std::string& canvas, const vision::CameraModel& camera,
                               const std::map<std::size_t, const LightSurvey::Output*>& surveys) {
    std::vector<vision::LitPart> parts;
    const std::vector<std::size_t> outputs = site.outputsOn(canvas);
    for (const std::size_t output : outputs) {
        const auto survey = surveys.find(output);
        if (survey == surveys.end())
            return Error(
                fmt::format("it shares the canvas '{}' with '{}', which was not measured; calibrate both, or say with "
                            "--wanted where the canvas is to stand",
                            canvas, site.outputs[output].name));
        parts.push_back({site.outputs[output].projection.warp.shape().part, &survey->second->map});
    }
    const show::Output& first = site.outputs[outputs[0]];
    const double known = first.projection.canvasAspect;
    const double aspect = known > 0 ? known : canvasAspectInPixels(site, canvas);
    Homography upright;
    if (first.surface) upright = vision::uprightFromView(camera, {first.surface->point, first.surface->normal});
    const auto place = vision::largestPlace(camera, parts, aspect, upright);
    if (!place) return Error("no place for its canvas is lit; its outputs' pictures must touch or overlap where their parts do");
    return *place;
}

// The place of a canvas by its markers, in the light of those of its outputs that were measured.
Result<Corners> markedPlaceOf(const show::Site& site, const std::string& canvas,
                              const std::map<std::size_t, const LightSurvey::Output*>& surveys) {
    std::vector<const LightSurvey::Output*> light;
    for (const std::size_t output : site.outputsOn(canvas))
        if (const auto survey = surveys.find(output); survey != surveys.end()) light.push_back(survey->second);
    return markedPlace(light);
}

// Fits one output's warp, and says in `trouble` why that is not good enough.
void fit(OutputCalibration& calibration, const LightSurvey::Output& survey, const vision::CameraModel& camera,
         const Result<Corners>& wanted, const WarpShape& now) {
    if (!wanted) {
        calibration.trouble = wanted.error().message();
        return;
    }
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
void dropMoved(LightSurvey& survey, const show::Site& site, std::vector<OutputCalibration>& calibrations,
               std::map<std::size_t, const LightSurvey::Output*>& surveys) {
    std::map<std::string, std::string> moved;  // by canvas: what is to be said
    for (OutputCalibration& calibration : calibrations) {
        const auto found = surveys.find(calibration.output);
        if (found == surveys.end()) continue;
        const show::Output& output = site.outputs[calibration.output];
        const auto distance = survey.movedSince(calibration.output, *found->second, kStill);
        if (!distance)
            calibration.note = fmt::format("whether something moved meanwhile is not known: {}", distance.error().message());
        else if (*distance > kStill)
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
    std::map<std::size_t, const LightSurvey::Output*> surveys;
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
    std::map<std::string, Result<Corners>> places;
    for (OutputCalibration& calibration : calibrations) {
        const auto found = surveys.find(calibration.output);
        if (found == surveys.end()) continue;
        const show::Output& output = site.outputs[calibration.output];
        const auto given = wanted.corners.find(output.name);
        if (given == wanted.corners.end() && !places.contains(output.canvas))
            places.emplace(output.canvas, wanted.markers ? markedPlaceOf(site, output.canvas, surveys)
                                                         : largestPlaceOf(site, output.canvas, camera, surveys));
        fit(calibration, *found->second, camera,
            given != wanted.corners.end() ? Result<Corners>(given->second) : places.at(output.canvas),
            output.projection.warp.shape());
        if (given != wanted.corners.end() || wanted.markers) continue;  // somebody has said which way up
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
