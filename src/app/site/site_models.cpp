#include "app/site/site_models.h"

#include "app/site/canvas_view.h"
#include "app/site/survey_file.h"

#include "core/config/config.h"
#include "core/parallel.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

namespace fantascope::app {
namespace {

vision::CameraModel projectorOf(const show::Output& output) {
    return vision::CameraModel::fromThrowRatio(output.projector->pose, output.size(), output.projector->throwRatio,
                                               output.projector->lensShift);
}

// Width / height of the whole canvas in an output's pixels.
double aspectInPixels(const show::Output& output) {
    const WarpShape& warp = output.projection.warp.shape();
    const auto& c = warp.corners;
    glm::dvec2 size(glm::distance(c[0], c[1]) + glm::distance(c[3], c[2]), glm::distance(c[0], c[3]) + glm::distance(c[1], c[2]));
    if (warp.orientation.quarterTurns % 2 != 0) std::swap(size.x, size.y);
    size /= warp.part.high - warp.part.low;
    return size.x / size.y;
}

// The precision of corners that are set by hand.
bool isRectangle(const std::array<glm::dvec2, 4>& c) {
    return isSameShape(glm::distance(c[0], c[1]), glm::distance(c[3], c[2])) &&
           isSameShape(glm::distance(c[0], c[3]), glm::distance(c[1], c[2])) &&
           isSameShape(glm::distance(c[0], c[2]), glm::distance(c[1], c[3]));
}

// Width / height of an output's canvas in metres on its surface. Nothing if the site does not say
// where projector and surface are.
std::optional<double> aspectOnSurface(const show::Output& output) {
    if (!output.projector || !output.surface) return std::nullopt;
    const std::vector<site::SceneObject> nothing;
    const vision::Plane surface{output.surface->point, output.surface->normal};
    const auto size = CanvasView{output.name, projectorOf(output), surface, output.projection.warp, nothing}.sizeOnSurface();
    if (!size) return std::nullopt;
    return size->x / size->y;
}

// The mean over a canvas's outputs; nothing if one of them has no value.
template <class Aspect>
std::optional<double> meanAspect(const show::Site& site, const std::string& canvas, const Aspect& aspectOf) {
    double sum = 0;
    const std::vector<std::size_t> outputs = site.outputsOn(canvas);
    for (const std::size_t output : outputs) {
        const std::optional<double> aspect = aspectOf(site.outputs[output]);
        if (!aspect) return std::nullopt;
        sum += *aspect;
    }
    return sum / static_cast<double>(outputs.size());
}

}  // namespace

Result<std::size_t> outputNamed(const show::Site& site, const std::string& name) {
    std::vector<std::string> names;
    for (const show::Output& output : site.outputs) names.push_back(output.name);
    const auto found = std::find(names.begin(), names.end(), name);
    if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
    const std::string nearest = nearestName(name, names);
    return Error(fmt::format(
        "{}: has no output '{}' ({})", site.file.string(), name,
        nearest.empty() ? fmt::format("its outputs: {}", fmt::join(names, ", ")) : fmt::format("did you mean '{}'?", nearest)));
}

Result<vision::CameraModel> cameraOf(const show::Site& site) {
    const show::NominalCamera& camera = *site.nominalCamera;
    return vision::CameraModel::fromFieldOfView(camera.pose, camera.size, camera.fieldOfView, camera.k1, camera.k2, camera.centre)
        .in(site.file.string() + ": camera");
}

vision::CameraLight cameraLightOf(const show::Site& site) {
    return {site.nominalCamera->response, site.nominalCamera->hotPixels};
}

std::shared_ptr<const render::BlendMap> blendOf(const show::Site& site, std::size_t output) {
    const std::vector<std::size_t> together = site.outputsOn(site.outputs[output].canvas);
    std::vector<Projection> projections;
    for (const std::size_t index : together) projections.push_back(site.outputs[index].projection);
    const auto which = static_cast<std::size_t>(std::find(together.begin(), together.end(), output) - together.begin());
    auto map = render::blendMap(projections, which, hardwareThreads());
    return map ? std::make_shared<const render::BlendMap>(std::move(*map)) : nullptr;
}

Result<site::NominalSite> simulationOf(const show::Site& site) {
    site::NominalSite nominal;
    for (const show::Output& output : site.outputs) {
        if (!output.projector)
            return Error(
                fmt::format("{}: output '{}' has no 'projector': the simulated site must know where it stands; add its position, "
                            "look_at and throw_ratio",
                            site.file.string(), output.name));
        nominal.outputs.push_back({output.name, projectorOf(output)});
        nominal.devices.push_back(output.name);
    }
    for (const show::Fixture& fixture : site.fixtures)
        nominal.fixtures.push_back({fixture.name, fixture.universe, fixture.address, fixture.channels});
    for (const show::Relay& relay : site.relays)
        nominal.relays.push_back({relay.name, site.relayBanks[relay.bank].name, static_cast<std::size_t>(relay.coil)});
    for (const show::Contact& contact : site.contacts)
        nominal.contacts.push_back({contact.name, site.contactBanks[contact.bank].name, static_cast<std::size_t>(contact.input)});
    for (const show::Universe& universe : site.universes) {
        nominal.devices.push_back(fmt::format("universe {}", universe.number));
        if (universe.desk) nominal.devices.push_back(fmt::format("desk {}", universe.number));
    }
    for (const show::Bank& bank : site.relayBanks) nominal.devices.push_back(bank.name);
    if (site.cueController) nominal.devices.emplace_back("cue controller");
    for (const show::Bank& bank : site.contactBanks) nominal.devices.push_back(bank.name);
    if (site.camera) {
        nominal.camera = TRY(cameraOf(site));
        nominal.devices.emplace_back("camera");
    }
    return nominal;
}

double canvasAspectInPixels(const show::Site& site, const std::string& canvas) {
    return *meanAspect(site, canvas, [](const show::Output& output) { return std::optional(aspectInPixels(output)); });
}

double canvasAspectOf(const show::Site& site, const std::string& canvas) {
    for (const std::size_t output : site.outputsOn(canvas))
        if (const auto& size = site.outputs[output].canvasSize) return size->x / size->y;
    if (const auto aspect = meanAspect(site, canvas, aspectOnSurface)) return *aspect;
    const auto ofRectangle = [](const show::Output& output) -> std::optional<double> {
        if (!isRectangle(output.projection.warp.shape().corners)) return std::nullopt;
        return aspectInPixels(output);
    };
    return meanAspect(site, canvas, ofRectangle).value_or(0);
}

Result<std::optional<vision::NominalView>> nominalViewOf(const show::Site& site, std::size_t output, double pictureAspect,
                                                         Fit fit) {
    const show::Output& from = site.outputs[output];
    if (!from.projector || !from.surface || !site.nominalCamera) return std::optional<vision::NominalView>();
    vision::NominalView view;
    view.camera = TRY(cameraOf(site));
    view.light = cameraLightOf(site);
    view.projector = projectorOf(from);
    view.canvasAspect = pictureAspect;
    view.warp = from.projection.warp;
    if (const double canvas = from.projection.canvasAspect; canvas > 0)
        view.warp = view.warp.ofPictureOn(placeOnCanvas(pictureAspect, canvas, fit));
    view.surface = {from.surface->point, from.surface->normal};
    return std::optional(view);
}

Result<std::vector<std::optional<vision::WatchedOutput>>> watchedOutputsOf(const show::Site& site) {
    constexpr double kUsualGamma = 2.2;
    std::vector<std::optional<vision::WatchedOutput>> watched(site.outputs.size());
    if (!site.camera || site.corrections.geometry.mode == show::Corrections::Mode::Off)
        return std::vector<std::optional<vision::WatchedOutput>>();
    const std::optional<Survey> survey = TRY(readSurvey(site));
    for (std::size_t i = 0; i < site.outputs.size(); ++i) {
        const show::Output& output = site.outputs[i];
        if (survey && survey->outputs.contains(output.name)) {
            const OutputSurvey& seen = survey->outputs.at(output.name);
            watched[i] = vision::WatchedOutput{seen.map, true, seen.projector, seen.gamma, seen.dark};
        } else if (const auto view = TRY(nominalViewOf(site, i, 1, Fit::Stretch))) {
            watched[i] = vision::WatchedOutput{
                vision::nominalMap(*view), false, output.size(), output.projection.light.gamma.value_or(kUsualGamma), {}};
        }
    }
    if (std::ranges::none_of(watched, [](const auto& output) { return output.has_value(); })) watched.clear();
    return watched;
}

}  // namespace fantascope::app
