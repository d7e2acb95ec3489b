#include "app/site/light_correction.h"

#include "app/site/site_models.h"
#include "app/site/survey_file.h"

#include "vision/light_compensation.h"

#include "core/parallel.h"

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <set>
#include <utility>

namespace fantascope::app {
namespace {

using Mode = show::Corrections::Mode;

// A mask stays dark on purpose; the light beneath it is judged as if it were not there.
show::Site withoutMasks(show::Site site) {
    for (show::Output& output : site.outputs) output.projection.masks.clear();
    return site;
}

// How much of a white canvas an output gives at each of its pixels.
GreyImage sharesOf(const show::Site& site, std::size_t output) {
    const Projection& projection = site.outputs[output].projection;
    const auto blend = blendOf(site, output);
    const CanvasPart shown = projection.warp.shown();
    GreyImage shares(projection.size.x, projection.size.y);
    parallelFor(shares.height(), hardwareThreads(), [&](int y) {
        for (int x = 0; x < shares.width(); ++x) {
            const auto canvas = projection.warp.canvasFromProjector({x + 0.5, y + 0.5});
            if (!canvas || glm::any(glm::lessThan(*canvas, shown.low)) || glm::any(glm::greaterThan(*canvas, shown.high)))
                continue;
            shares.at(x, y) = blend ? blend->at(x, y).x : 1;
        }
    });
    return shares;
}

double brightnessOf(const ProjectorLight& light) { return light.brightness * glm::dot(light.white, glm::dvec3(1)) / 3; }

// Error: why an output's survey cannot be used, and what to do.
Result<const OutputSurvey*> surveyed(const Survey& survey, const show::Output& output) {
    const auto found = survey.outputs.find(output.name);
    if (found != survey.outputs.end()) return &found->second;
    const auto unfit = survey.unfit.find(output.name);
    return Error(fmt::format(
        "output '{}': {}", output.name,
        unfit != survey.unfit.end() ? unfit->second : "it was not surveyed; 'fantascope calibrate SITE --write' does that"));
}

// `site`: without masks.
Result<void> correct(LightCorrection& correction, const show::Site& site, const Survey& survey) {
    std::vector<GreyImage> shares;
    std::vector<vision::LitOutput> lit;
    shares.reserve(correction.outputs.size());  // `lit` points into it
    for (const std::size_t output : correction.outputs) {
        const OutputSurvey* const seen = TRY(surveyed(survey, site.outputs[output]));
        shares.push_back(sharesOf(site, output));
        lit.push_back({&seen->map, &shares.back(), brightnessOf(site.outputs[output].projection.light)});
    }
    const show::Corrections::Light& bounds = site.corrections.light;
    auto made = vision::compensateLight(lit, {bounds.least, bounds.clipped});
    if (!made) return Error("the camera sees too little of its picture; turn the camera towards it and calibrate again");
    for (GreyImage& gain : made->gains) correction.gains.push_back(std::make_shared<const GreyImage>(std::move(gain)));
    correction.kept = made->kept;
    correction.tooDark = made->tooDark;
    correction.tooBright = made->tooBright;
    return {};
}

Result<Survey> surveyOf(const show::Site& site) {
    auto survey = TRY(readSurvey(site));
    if (!survey)
        return Error(
            fmt::format("there is no survey of the site; 'fantascope calibrate {} --write' makes one", site.file.string()));
    return std::move(*survey);
}

}  // namespace

std::vector<LightCorrection> lightCorrectionsOf(const show::Site& site) {
    std::vector<LightCorrection> corrections;
    const Mode mode = site.corrections.light.mode;
    std::error_code ignored;
    if (mode == Mode::Off || (mode == Mode::Advise && !std::filesystem::exists(surveyFileOf(site.file), ignored))) return {};
    const auto survey = surveyOf(site);
    const show::Site bare = withoutMasks(site);
    std::set<std::string> canvases;
    for (const show::Output& output : site.outputs) {
        if (!canvases.insert(output.canvas).second) continue;
        LightCorrection& correction = corrections.emplace_back();
        correction.canvas = output.canvas;
        correction.outputs = site.outputsOn(output.canvas);
        const auto done = survey ? correct(correction, bare, *survey) : Result<void>(survey.error());
        if (!done) correction.trouble = done.error().message();
    }
    return corrections;
}

std::shared_ptr<const GreyImage> gainOf(const std::vector<LightCorrection>& corrections, std::size_t output) {
    for (const LightCorrection& correction : corrections) {
        const auto found = std::ranges::find(correction.outputs, output);
        if (found != correction.outputs.end() && !correction.gains.empty())
            return correction.gains[static_cast<std::size_t>(found - correction.outputs.begin())];
    }
    return nullptr;
}

std::vector<std::shared_ptr<const GreyImage>> gainsToApply(const show::Site& site,
                                                           const std::vector<LightCorrection>& corrections) {
    std::vector<std::shared_ptr<const GreyImage>> gains(site.outputs.size());
    if (site.corrections.light.mode != Mode::Automatic) return gains;
    for (std::size_t output = 0; output < gains.size(); ++output) gains[output] = gainOf(corrections, output);
    return gains;
}

std::vector<show::event::LightCorrected> lightNewsOf(const show::Site& site, const std::vector<LightCorrection>& corrections) {
    std::vector<show::event::LightCorrected> news;
    const bool applied = site.corrections.light.mode == Mode::Automatic;
    for (const LightCorrection& one : corrections)
        news.push_back({one.canvas, one.kept, one.tooDark, one.tooBright, applied, one.trouble});
    return news;
}

Result<vision::CanvasSurface> canvasSurface(const show::Site& site, std::size_t output, double aspect, Fit fit, glm::ivec2 size) {
    const Survey survey = TRY(surveyOf(site));
    const show::Site bare = withoutMasks(site);
    std::vector<LightCorrection> corrections;
    if (site.corrections.light.mode == Mode::Automatic) corrections = lightCorrectionsOf(site);
    const double canvas = site.outputs[output].projection.canvasAspect;
    const CanvasPart place = canvas > 0 ? placeOnCanvas(aspect, canvas, fit) : CanvasPart();
    vision::CanvasSurface surface;
    for (const std::size_t which : site.outputsOn(site.outputs[output].canvas)) {
        const Projection& projection = bare.outputs[which].projection;
        const OutputSurvey* const seen = TRY(surveyed(survey, site.outputs[which]));
        const auto light = vision::lightByProjectorPixel(seen->map, projection.size);
        if (!light) return Error(fmt::format("output '{}': the camera sees too little of it", site.outputs[which].name));
        const auto gain = gainOf(corrections, which);
        const GreyImage shares = sharesOf(bare, which);
        const auto brightness = static_cast<float>(brightnessOf(projection.light));
        vision::CanvasSurface::Part part{which, GreyImage(size.x, size.y), Image<glm::vec2>(size.x, size.y)};
        for (int y = 0; y < size.y; ++y)
            for (int x = 0; x < size.x; ++x) {
                const glm::dvec2 at = glm::mix(place.low, place.high, (glm::dvec2(x, y) + 0.5) / glm::dvec2(size));
                const glm::dvec2 pixel = projection.warp.projectorFromCanvas(at);
                if (glm::any(glm::lessThan(pixel, glm::dvec2(0)))) continue;
                if (glm::any(glm::greaterThanEqual(pixel, glm::dvec2(projection.size)))) continue;
                const glm::ivec2 there(pixel);
                part.pixel.at(x, y) = glm::vec2(pixel);
                part.light.at(x, y) = light->at(there.x, there.y) * (gain ? gain->at(there.x, there.y) : 1.0f) * brightness *
                                      shares.at(there.x, there.y);
            }
        surface.parts.push_back(std::move(part));
    }
    return surface;
}

}  // namespace fantascope::app
