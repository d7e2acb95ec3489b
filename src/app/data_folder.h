#pragma once

#include <filesystem>

namespace fantascope::app {

// Where the program's own files are (assets, config, shows): $FANTASCOPE_DATA if set, else the folder that it was built from.
std::filesystem::path dataFolder();

}  // namespace fantascope::app
