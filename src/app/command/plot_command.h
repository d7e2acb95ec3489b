#pragma once

#include "app/base/command.h"

namespace fantascope::app {

// `fantascope plot PATTERN|REPORT|CAST -o PNG|SVG`: draws figures.
void addPlotCommand(Program& program);

}  // namespace fantascope::app
