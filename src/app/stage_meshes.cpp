#include "app/stage_meshes.h"

#include "app/report.h"

#include "theatre/scene_energy.h"

#include <fmt/format.h>

namespace fantascope::app {

Result<void> writeStageMeshes(const std::filesystem::path& folder, const theatre::PoseProblem& problem,
                              std::span<const double> freedoms) {
    theatre::SceneEnergy scene(problem);
    scene.pose(freedoms);
    for (std::size_t i = 0; i < problem.actors.size(); ++i) {
        const std::span<const glm::vec3> skin = scene.skin(i);
        TRY(writeObj(folder / fmt::format("actor-{}.obj", i + 1),
                     {{skin.begin(), skin.end()}, problem.skins[i]->atRest.triangles}));
    }
    for (const auto& thing : scene.things()) TRY(writeObj(folder / fmt::format("prop-{}.obj", thing.name), thing.mesh));
    const theatre::ScreenFrame& picture = problem.target.given;
    const glm::dvec2 origin = picture.metresAt({0, 0}), size = picture.pixel() * glm::dvec2(picture.width(), picture.height());
    const glm::dvec3 light = problem.stage.light;
    Report report;
    report["light"] = {light.x, light.y, light.z};
    report["screen"] = {{"origin", {origin.x, origin.y, 0}}, {"u", {size.x, 0, 0}}, {"v", {0, -size.y, 0}}};
    report["target_px"] = {picture.width(), picture.height()};
    return writeReport(folder / "stage.json", report);
}

}  // namespace fantascope::app
