#include "plot/cast_picture.h"

#include "theatre/mesh_shadow.h"

#include "core/check.h"
#include "plot/palette.h"

#include <fmt/format.h>

#include <cmath>

namespace fantascope::plot {
namespace {

using theatre::BitMask, theatre::PoseSearch;

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
    const theatre::ScreenFrame& frame = problem.target.frame;
    const BitMask black(frame.width(), frame.height());
    CastPicture picture{{problem.stage, frame, black, problem.target.mask, {}}, {}, {}};
    std::string fallen;
    theatre::MeshShadow shadow;
    theatre::PosedBody posed;
    std::vector<glm::vec3> vertices;
    for (std::size_t i = 0; i < problem.actors.size(); ++i) {
        const theatre::Body& body = problem.actors[i];
        posed.pose(body, freedoms.first(body.freedoms));
        freedoms = freedoms.subspan(body.freedoms);
        picture.actors.push_back({black, fmt::format("{:.2f} m", body.stature), notesOf(quality.actors[i])});
        const theatre::BodyMesh& skin = *problem.skins[i];
        skin.skin(body, posed, vertices);
        shadow.add(frame, skin, vertices, picture.actors[i].mask);
        if (picture.actors[i].mask.count() == 0) picture.actors[i].notes.push_back("no shadow in the picture");
        picture.view.shadow.add(picture.actors[i].mask);
        picture.view.actors.push_back({{vertices, skin.atRest.triangles}, actorColour(i)});
        if (!quality.actors[i].isValid()) fallen += fmt::format("{} {}", fallen.empty() ? "" : ",", i + 1);
    }
    picture.lines = {fmt::format("IoU {:.3f}", quality.iou), fmt::format("contour off by {:.1f} px of 256,", quality.contourMean),
                     fmt::format("{:.0f} px at most", quality.contourMost),
                     fallen.empty() ? "everyone can stand so" : "cannot stand so:" + fallen};
    return picture;
}

}  // namespace fantascope::plot
