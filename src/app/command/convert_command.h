#pragma once

#include "app/base/command.h"

namespace fantascope::app {

// `fantascope convert`: a cast's motion as a scene that other programs read.
void addConvertCommand(CLI::App& program, Action& action);

}  // namespace fantascope::app
