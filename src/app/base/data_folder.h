#pragma once

#include "core/result.h"

#include <filesystem>

namespace fantascope::app {

// The folder with the program's own files: assets, config and shows. $FANTASCOPE_DATA if that is
// set. Otherwise the nearest such folder at or above the program's own, or share/fantascope in one
// of them: the source tree for build/PRESET/fantascope, PREFIX/share/fantascope for
// PREFIX/bin/fantascope. Error: there is none; it says where it looked. Thread: reentrant.
Result<std::filesystem::path> dataFolder();

}  // namespace fantascope::app
