#pragma once

#include "app/base/command.h"

namespace fantascope::app {

// `deform SILHOUETTE --motion M.motion.yaml -o FOLDER`: a silhouette that moves with its handles.
void addDeformCommand(Program& program);

}  // namespace fantascope::app
