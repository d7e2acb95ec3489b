#include "app/stage_meshes.h"

#include "app/report.h"

#include <fmt/format.h>

namespace fantascope::app {

std::vector<TriangleMesh> skinsOf(const theatre::PoseProblem& problem, std::span<const double> freedoms) {
    std::vector<TriangleMesh> skins;
    theatre::PosedBody posed;
    for (std::size_t i = 0; i < problem.actors.size(); ++i) {
        const theatre::Body& body = problem.actors[i];
        posed.pose(body, freedoms.first(body.freedoms));
        freedoms = freedoms.subspan(body.freedoms);
        skins.push_back({{}, problem.skins[i]->atRest.triangles});
        problem.skins[i]->skin(body, posed, skins.back().vertices);
    }
    return skins;
}

Result<void> writeStageMeshes(const std::filesystem::path& folder, const theatre::PoseTarget& target, const theatre::Stage& stage,
                              std::span<const TriangleMesh> skins) {
    for (std::size_t i = 0; i < skins.size(); ++i) TRY(writeObj(folder / fmt::format("actor-{}.obj", i + 1), skins[i]));
    const theatre::ScreenFrame& picture = target.given;
    const glm::dvec2 origin = picture.metresAt({0, 0}), size = picture.pixel() * glm::dvec2(picture.width(), picture.height());
    Report report;
    report["light"] = {stage.light.x, stage.light.y, stage.light.z};
    report["screen"] = {{"origin", {origin.x, origin.y, 0}}, {"u", {size.x, 0, 0}}, {"v", {0, -size.y, 0}}};
    report["target_px"] = {picture.width(), picture.height()};
    return writeReport(folder / "stage.json", report);
}

}  // namespace fantascope::app
