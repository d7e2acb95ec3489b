#pragma once

#include "app/base/command.h"

namespace fantascope::app {

// `fantascope template SITE --output NAME -o PNG`: draws the scene from the projector's point of
// view, as a picture to draw a guide over. See docs/drawing.md.
void addTemplateCommand(Program& program);

}  // namespace fantascope::app
