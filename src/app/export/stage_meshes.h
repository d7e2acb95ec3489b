#pragma once

#include "theatre/energy/pose_problem.h"

#include "core/result.h"

#include <filesystem>
#include <span>

namespace fantascope::app {

// What anybody needs to cast the shadow of poses again (all degrees of freedom of a problem with
// skins): a Wavefront OBJ for each actor, actor-1.obj and so on, and for each platform and prop,
// prop-NAME.obj, in the stage's frame, metres; and stage.json with the light, where the target's
// picture hangs on the screen, and its size, and the same of further_beams. On a curved screen it
// hangs on the plane that the screen `touches` at a point, and is to be rolled up around the
// upright through it by the `radius` (screen.h). Error: a file cannot be written.
Result<void> writeStageMeshes(const std::filesystem::path& folder, const theatre::PoseProblem& problem,
                              std::span<const double> dofs);

}  // namespace fantascope::app
