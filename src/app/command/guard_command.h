#pragma once

#include "app/base/command.h"

namespace fantascope::app {

void addGuardCommand(CLI::App& program, Action& action);

}  // namespace fantascope::app
