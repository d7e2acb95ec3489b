#pragma once

#include "app/base/command.h"

namespace fantascope::app {

// `fantascope pattern GUIDE -o P.pattern.yaml`: finds a light pattern that reads as the artist's
// drawing. The pattern's folder holds everything that it needs: files from elsewhere are copied
// into it, as P.guide.png and P.NAME.obj.
void addPatternCommand(Program& program);

}  // namespace fantascope::app
