#include "app/calibrate/output_light.h"

#include "vision/projector_response.h"

#include "core/result.h"

#include <fmt/format.h>
#include <glm/vec2.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

namespace fantascope::app {
namespace {

// Finer steps than these are not measured; files stay readable.
constexpr double kGammaGrain = 100, kWhiteGrain = 1000;

double inSteps(double value, double grain) { return std::round(value * grain) / grain; }

// The light of the primaries in the part of the canvas that the output shows.
std::vector<vision::PrimaryLight> onCanvas(const FittedOutput& fitted) {
    std::vector<vision::PrimaryLight> within;
    const auto warp = Warp::of(fitted.warp);
    if (!warp) return within;
    const CanvasPart shown = warp->shown();
    for (const vision::PrimaryLight& light : fitted.survey->primaries) {
        const glm::vec2 pixel = fitted.survey->map.at.pixels()[light.pixel];
        if (std::isnan(pixel.x)) continue;
        const auto canvas = warp->canvasFromProjector(glm::dvec2(pixel));
        if (canvas && glm::all(glm::greaterThanEqual(*canvas, shown.low)) && glm::all(glm::lessThanEqual(*canvas, shown.high)))
            within.push_back(light);
    }
    return within;
}

// The whites of a canvas's outputs, in the order of `together`. Error: why they are not matched.
Result<std::vector<glm::dvec3>> whitesOf(const std::vector<std::size_t>& together, const std::vector<FittedOutput>& fitted) {
    std::vector<std::vector<vision::PrimaryLight>> primaries;
    for (const std::size_t output : together) {
        const auto found = std::ranges::find(fitted, output, &FittedOutput::output);
        if (found == fitted.end())
            return Error("its white is not matched: other outputs of its canvas were not measured with it");
        primaries.push_back(onCanvas(*found));
    }
    auto whites = vision::matchedWhites(primaries);
    if (!whites)
        return Error(
            "its white is not matched: the camera sees too little of where its canvas's outputs overlap, or is saturated there");
    for (glm::dvec3& white : *whites)
        for (int channel = 0; channel < 3; ++channel) white[channel] = inSteps(white[channel], kWhiteGrain);
    return std::move(*whites);
}

}  // namespace

std::map<std::size_t, MeasuredLight> measuredLights(const show::Site& site, const std::vector<FittedOutput>& fitted) {
    std::map<std::size_t, MeasuredLight> lights;
    std::set<std::string> canvases;
    for (const FittedOutput& one : fitted) {
        MeasuredLight& light = lights[one.output];
        if (one.survey->gammaIsKnown)
            light.gamma = inSteps(one.survey->gamma, kGammaGrain);
        else
            light.trouble = "the light of its greys follows no gamma";
        canvases.insert(site.outputs[one.output].canvas);
    }
    for (const std::string& canvas : canvases) {
        const std::vector<std::size_t> together = site.outputsOn(canvas);
        if (together.size() == 1) continue;
        const auto whites = whitesOf(together, fitted);
        for (std::size_t i = 0; i < together.size(); ++i) {
            const auto light = lights.find(together[i]);
            if (light == lights.end()) continue;
            if (whites)
                light->second.white = (*whites)[i];
            else
                light->second.trouble += (light->second.trouble.empty() ? "" : "; ") + whites.error().message();
        }
    }
    return lights;
}

ProjectorLight withMeasured(ProjectorLight light, const MeasuredLight& measured) {
    if (measured.gamma) light.gamma = measured.gamma;
    if (measured.white) light.white = *measured.white;
    return light;
}

std::string wordsOf(const MeasuredLight& measured) {
    std::string words;
    if (measured.gamma) words = fmt::format("gamma {:g}", *measured.gamma);
    if (measured.white)
        words += fmt::format("{}white [{:g}, {:g}, {:g}]", words.empty() ? "" : ", ", measured.white->r, measured.white->g,
                             measured.white->b);
    return words;
}

}  // namespace fantascope::app
