#pragma once

#include "theatre/pose_problem.h"

#include "core/mesh.h"
#include "core/result.h"

#include <filesystem>
#include <span>
#include <vector>

namespace fantascope::app {

// The skins of the actors of a problem that has them, in poses (all freedoms, one actor after the other): metres, stage frame.
std::vector<TriangleMesh> skinsOf(const theatre::PoseProblem& problem, std::span<const double> freedoms);

// What anybody needs to cast the shadow again: a Wavefront OBJ for each actor, actor-1.obj and so on, and stage.json with the light, where the
// target's picture hangs on the screen, and its size. Error: a file cannot be written.
Result<void> writeStageMeshes(const std::filesystem::path& folder, const theatre::PoseTarget& target, const theatre::Stage& stage,
                              std::span<const TriangleMesh> skins);

}  // namespace fantascope::app
