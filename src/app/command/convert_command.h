#pragma once

#include "app/base/command.h"

namespace fantascope::app {

// `fantascope convert`: writes a cast's poses or motion as a scene for other programs.
void addConvertCommand(Program& program);

}  // namespace fantascope::app
