#pragma once

#include "app/base/command.h"

namespace fantascope::app {

// `fantascope template SITE --output NAME -o PNG`: the picture to draw a guide over, the scene from
// the projector's point of view. docs/drawing.md.
void addTemplateCommand(CLI::App& program, Action& action);

}  // namespace fantascope::app
