#pragma once

#include "core/result.h"

#include <filesystem>

namespace fantascope::app {

// The folder with the program's own files: assets, config and shows. $FANTASCOPE_DATA if that is
// set; else the nearest such folder at or above the program's own, or the share/fantascope of one
// of them: a source tree for build/PRESET/fantascope, PREFIX/share/fantascope for
// PREFIX/bin/fantascope. Error: there is none; says where it was looked for. Thread: reentrant.
Result<std::filesystem::path> dataFolder();

}  // namespace fantascope::app
