#pragma once

#include "app/base/command.h"

namespace fantascope::app {

// `fantascope plot PATTERN|REPORT|CAST -o PNG|SVG`: draws figures.
void addPlotCommand(CLI::App& program, Action& action);

}  // namespace fantascope::app
