#pragma once

#include "app/base/command.h"

namespace fantascope::app {

// `pose TARGET -o C.cast.yaml`: people whose shadow is a silhouette.
void addPoseCommand(Program& program);

}  // namespace fantascope::app
