#pragma once

#include "app/base/command.h"

namespace fantascope::app {

// `fantascope adapt`: principal poses follow a silhouette that moves.
void addAdaptCommand(Program& program);

}  // namespace fantascope::app
