#pragma once

#include "app/base/command.h"

namespace fantascope::app {

// `fantascope devices`: lists devices that it finds, reports the state of a site's devices, or
// tries one of them.
void addDevicesCommand(Program& program);

}  // namespace fantascope::app
