#pragma once

#include "app/base/command.h"

namespace fantascope::app {

// fantascope rehearse [SHOW]: a show on the simulated site, in real time or as fast as possible.
void addRehearseCommand(Program& program);
// fantascope run SHOW --site SITE: a show on the devices that the site file names.
void addRunCommand(Program& program);

}  // namespace fantascope::app
