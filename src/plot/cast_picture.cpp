#include "plot/cast_picture.h"

#include "theatre/scene_energy.h"

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
    constexpr double kShown = 0.0005;  // metres; less is 0.0 cm
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

CastPicture castPicture(const theatre::PoseProblem& problem, std::span<const double> freedoms) {
    FANTASCOPE_CHECK(problem.skins.size() == problem.actors.size(), "pictures of a cast show skins");
    const PoseSearch::Quality quality = PoseSearch::measure(problem, freedoms);
    theatre::SceneEnergy scene(problem);
    scene.pose(freedoms);
    scene.terms();
    CastPicture picture{{problem.stage, problem.target.frame, scene.shadow(), problem.target.mask, {}}, {}, {}};
    std::string fallen;
    for (std::size_t i = 0; i < problem.actors.size(); ++i) {
        const PoseSearch::Actor& actor = quality.actors[i];
        picture.actors.push_back(
            {scene.shadow(i), fmt::format("actor {}, {:.2f} m", i + 1, problem.actors[i].stature), notesOf(actor)});
        if (scene.shadow(i).count() == 0) picture.actors[i].notes.push_back("no shadow in the picture");
        const std::span<const glm::vec3> skin = scene.skin(i);
        picture.view.actors.push_back({{{skin.begin(), skin.end()}, problem.skins[i]->atRest.triangles}, actorColour(i)});
        if (!actor.isValid()) fallen += fmt::format("{} {}", fallen.empty() ? "" : ",", i + 1);
    }
    const auto things = scene.things();
    const glm::dvec3 colour = actorColour(problem.actors.size());
    for (const auto& thing : things) picture.view.props.push_back({thing.mesh, colour});
    if (!things.empty()) picture.actors.push_back({scene.beam(0).propShadow(), things.size() == 1 ? things[0].name : "props", {}});
    picture.lines = {fmt::format("IoU {:.3f}", quality.iou), fmt::format("contour off by {:.1f} px of 256,", quality.contourMean),
                     fmt::format("{:.0f} px at most", quality.contourMost),
                     fallen.empty() ? "everyone can stand so" : "cannot stand so:" + fallen};
    return picture;
}

}  // namespace fantascope::plot
