#pragma once

#include "show/site/site.h"

#include "core/result.h"

#include <filesystem>

namespace fantascope::app {

// Reads a whole site file, or the site.yaml of a folder: the site, every device's own keys by its
// driver, what devices share, and the simulated site. Sets the shape of every output's canvas.
// Opens no device; what it accepts can be opened. Error: all faults, one a line.
Result<show::Site> readSite(const std::filesystem::path& fileOrFolder);

// Swaps a site file with its FILE.previous. `file` may be a folder. Returns the site file. Error:
// there is no FILE.previous, or it is no site; both stay as they were.
Result<std::filesystem::path> undoWrite(const std::filesystem::path& file);

}  // namespace fantascope::app
