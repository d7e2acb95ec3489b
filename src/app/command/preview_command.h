#pragma once

#include "app/base/command.h"

namespace fantascope::app {

// `fantascope preview PATTERN --scene MESH -o PNG`: shows a pattern as a light mask projected on a
// 3D scene, as a picture or as a film of its movement. See docs/drawing.md.
void addPreviewCommand(Program& program);

}  // namespace fantascope::app
