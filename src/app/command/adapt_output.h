#pragma once

#include "app/command/adapt_input.h"

#include <string>

namespace fantascope::app {

// The motion as a cast, with all that it names.
Result<void> writeMotion(const Adapted& adapted);
// The sheet and the video, if the options ask for them.
Result<void> drawMotion(const Adapted& adapted);
// The figures. `seconds`: what the run took.
Result<void> writeFigures(const std::filesystem::path& file, const Adapted& adapted, double seconds);
// One line for a person.
std::string brief(const Adapted& adapted);

}  // namespace fantascope::app
