#pragma once

#include "app/base/command.h"

namespace fantascope::app {

// fantascope rehearse [SHOW]: a show on the simulated site, in real time or as fast as possible.
void addRehearseCommand(CLI::App& program, Action& action);
// fantascope run SHOW --site SITE: a show on the devices that the site file names.
void addRunCommand(CLI::App& program, Action& action);

}  // namespace fantascope::app
