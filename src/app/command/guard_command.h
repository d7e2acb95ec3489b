#pragma once

#include "app/base/command.h"

namespace fantascope::app {

void addGuardCommand(Program& program);

}  // namespace fantascope::app
