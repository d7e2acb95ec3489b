#pragma once

#include "app/base/command.h"

namespace fantascope::app {

// `fantascope export SHOW --output NAME -o FILE|DIR`: writes an output's frames for other programs,
// as pictures with alpha or as a video. SHOW may be a single pattern. See docs/drawing.md.
void addExportCommand(Program& program);

}  // namespace fantascope::app
