#pragma once

#include "app/base/command.h"

namespace fantascope::app {

// `fantascope export SHOW --output NAME -o FILE|DIR`: what one output shows, frame by frame of show
// time, for other programs: pictures with alpha, or a video. Also of a single pattern.
// docs/drawing.md.
void addExportCommand(CLI::App& program, Action& action);

}  // namespace fantascope::app
