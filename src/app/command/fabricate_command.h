#pragma once

#include "app/base/command.h"

namespace fantascope::app {

// `fantascope fabricate`: a cast's poses as one solid that a printer makes, with a sheet to set up
// its lamp.
void addFabricateCommand(Program& program);

}  // namespace fantascope::app
