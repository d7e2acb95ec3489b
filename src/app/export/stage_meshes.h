#pragma once

#include "theatre/energy/pose_problem.h"

#include "core/result.h"

#include <filesystem>
#include <span>

namespace fantascope::app {

// Writes everything needed to reproduce the shadow of poses in another program. `dofs`: all actors'
// degrees of freedom, of a problem with skins. The files are a Wavefront OBJ per actor, actor-1.obj
// and so on, and per platform and prop, prop-NAME.obj, in the stage's frame, metres; and stage.json
// with the light, the place and size of the target's picture on the screen, and the same for each
// of further_beams. For a curved screen, the picture lies on the plane that `touches` the screen at
// a point, and is to be rolled with the `radius` around the vertical through that point (screen.h).
// Error: a file cannot be written.
Result<void> writeStageMeshes(const std::filesystem::path& folder, const theatre::PoseProblem& problem,
                              std::span<const double> dofs);

}  // namespace fantascope::app
