#include "plot/cast_picture.h"

#include "theatre/energy/scene_energy.h"

#include "core/check.h"
#include "plot/palette.h"

#include <fmt/format.h>

#include <cmath>

namespace fantascope::plot {
namespace {

using theatre::PoseSearch;

std::vector<std::string> notesOf(const PoseSearch::Actor& actor) {
    std::vector<std::string> notes;
    const double margin = 100 * actor.margin;
    notes.push_back(!actor.touches ? "does not touch the floor"
                    : margin >= 0  ? fmt::format("balanced with {:.1f} cm to spare", margin)
                                   : fmt::format("falls: {:.1f} cm off balance", -margin));
    constexpr double kShown = 0.0005;  // metres; less would be shown as 0.0 cm
    notes.push_back(std::abs(actor.lowest) < kShown
                        ? "lowest point on the floor"
                        : fmt::format("lowest point {:.1f} cm {} the floor", 100 * std::abs(actor.lowest),
                                      actor.lowest < 0 ? "below" : "above"));
    notes.push_back(actor.deepest < kShown ? "runs into nothing"
                                           : fmt::format("{:.1f} cm deep in something", 100 * actor.deepest));
    if (!actor.withinLimits) notes.push_back("a joint is turned too far");
    return notes;
}

}  // namespace

CastPicture castPicture(const theatre::PoseProblem& problem, std::span<const double> dofs) {
    FANTASCOPE_CHECK(problem.skins.size() == problem.actors.size(), "every actor has a skin");
    const PoseSearch::Quality quality = PoseSearch::measure(problem, dofs);
    theatre::SceneEnergy scene(problem);
    scene.pose(dofs);
    scene.terms();
    CastPicture picture{{problem.stage, {}, {}}, {}};
    const auto things = scene.things();
    const glm::dvec3 colour = actorColour(problem.actors.size());
    for (const auto& thing : things) picture.view.props.push_back({thing.mesh, colour});
    std::string fallen;
    for (std::size_t i = 0; i < problem.actors.size(); ++i) {
        const std::span<const glm::vec3> skin = scene.skin(i);
        picture.view.actors.push_back({{{skin.begin(), skin.end()}, problem.skins[i]->atRest.triangles}, actorColour(i)});
        if (!quality.actors[i].isValid()) fallen += fmt::format("{} {}", fallen.empty() ? "" : ",", i + 1);
    }
    for (std::size_t k = 0; k < problem.targets.size(); ++k) {
        const theatre::BeamEnergy& beam = scene.beam(k);
        const theatre::PoseTarget& target = beam.target();
        picture.view.images.push_back({target.frameAsSeen(), target.asSeen(beam.shadow()), target.maskAsSeen()});
        CastPicture::Image image{{}, target.maskAsSeen(), {}};
        for (std::size_t i = 0; i < problem.actors.size(); ++i) {
            image.actors.push_back({target.asSeen(beam.shadow(i)),
                                    fmt::format("actor {}, {:.2f} m", i + 1, problem.actors[i].stature),
                                    notesOf(quality.actors[i])});
            if (beam.shadow(i).count() == 0) image.actors[i].notes.push_back("no shadow in the picture");
        }
        if (!things.empty())
            image.actors.push_back({target.asSeen(beam.propShadow()), things.size() == 1 ? things[0].name : "props", {}});
        const PoseSearch::Quality::Match& match = quality.matches[k];
        if (problem.targets.size() > 1) image.lines.push_back(fmt::format("beam {}", k + 1));
        for (const std::string& line : std::vector<std::string>{
                 fmt::format("IoU {:.3f}", match.iou), fmt::format("contour off by {:.1f} px of 256,", match.contourMean),
                 fmt::format("{:.0f} px at most", match.contourMost),
                 fallen.empty() ? "everyone can stand so" : "cannot stand so:" + fallen})
            image.lines.push_back(line);
        picture.images.push_back(std::move(image));
    }
    return picture;
}

Page CastPicture::shadows() const {
    std::vector<Page> pages;
    for (const Image& image : images) pages.push_back(shadowFigure(image.actors, image.target, image.lines));
    return pages.size() == 1 ? std::move(pages[0]) : stacked(pages);
}

Page CastPicture::each() const {
    std::vector<Page> pages;
    for (const Image& image : images) pages.push_back(actorsFigure(image.actors, image.target));
    return pages.size() == 1 ? std::move(pages[0]) : stacked(pages);
}

}  // namespace fantascope::plot
