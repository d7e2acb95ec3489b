#pragma once

#include "app/base/command.h"

namespace fantascope::app {

// `fantascope pattern GUIDE -o P.pattern.yaml`: a light pattern that reads as the artist's drawing.
// The file's folder then holds all that it needs: what lies elsewhere is copied beside it, as
// P.guide.png and P.NAME.obj.
void addPatternCommand(CLI::App& program, Action& action);

}  // namespace fantascope::app
