#pragma once

#include "app/base/command.h"

namespace fantascope::app {

// `fantascope preview PATTERN --scene MESH -o PNG`: a pattern as a projective light mask on a 3D
// scene, as a picture or a film of its sway. docs/drawing.md.
void addPreviewCommand(CLI::App& program, Action& action);

}  // namespace fantascope::app
