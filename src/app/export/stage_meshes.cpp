#include "app/export/stage_meshes.h"

#include "app/base/report.h"

#include "theatre/energy/scene_energy.h"

#include <fmt/format.h>

namespace fantascope::app {
namespace {

// A beam's light, the rectangle of its screen that the target's picture covers, and the picture's
// size.
Report beamOf(const theatre::PoseProblem& problem, std::size_t beam) {
    const theatre::ScreenFrame& picture = problem.targets[beam].given;
    const theatre::Screen& screen = problem.stage.screenOf(beam);
    const auto list = [](const glm::dvec3& v) { return Report{v.x, v.y, v.z}; };
    const glm::dvec2 leftTop = picture.metresAt({0, 0}), size = picture.pixel() * glm::dvec2(picture.width(), picture.height());
    const glm::dvec3 origin = screen.stageFromScreen({leftTop, 0});
    Report report;
    report["light"] = list(problem.stage.beams[beam].light);
    report["screen"] = {{"origin", list(origin)},
                        {"u", list(screen.stageFromScreen({leftTop.x + size.x, leftTop.y, 0}) - origin)},
                        {"v", list(screen.stageFromScreen({leftTop.x, leftTop.y - size.y, 0}) - origin)}};
    // The rectangle is rolled around the vertical through the frame's x = 0.
    if (screen.isCurved())
        report["screen"]["radius"] = screen.radius, report["screen"]["touches"] = list(screen.stageFromScreen({0, 0, 0}));
    report["target_px"] = {picture.width(), picture.height()};
    return report;
}

}  // namespace

Result<void> writeStageMeshes(const std::filesystem::path& folder, const theatre::PoseProblem& problem,
                              std::span<const double> dofs) {
    theatre::SceneEnergy scene(problem);
    scene.pose(dofs);
    for (std::size_t i = 0; i < problem.actors.size(); ++i) {
        const std::span<const glm::vec3> skin = scene.skin(i);
        TRY(writeObj(folder / fmt::format("actor-{}.obj", i + 1),
                     {{skin.begin(), skin.end()}, problem.skins[i]->atRest.triangles}));
    }
    for (const auto& thing : scene.things()) TRY(writeObj(folder / fmt::format("prop-{}.obj", thing.name), thing.mesh));
    Report report = beamOf(problem, 0);
    for (std::size_t i = 1; i < problem.targets.size(); ++i) report["further_beams"].push_back(beamOf(problem, i));
    return writeReport(folder / "stage.json", report);
}

}  // namespace fantascope::app
