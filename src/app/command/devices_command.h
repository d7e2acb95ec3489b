#pragma once

#include "app/base/command.h"

namespace fantascope::app {

// `fantascope devices`: what is there, what a site's devices say of themselves, and a trial of one
// of them.
void addDevicesCommand(CLI::App& program, Action& action);

}  // namespace fantascope::app
