#pragma once

#include "show/site.h"

#include "core/result.h"

#include <filesystem>

namespace fantascope::app {

// Reads a site file (or the site.yaml of a folder) whole: show's part, every device's own keys by
// its driver, what devices share, and the simulated site. Every output knows the shape of its
// canvas. Opens nothing. Whatever passes can be opened. Error: all that is wrong, a line for each.
Result<show::Site> readSite(const std::filesystem::path& fileOrFolder);

}  // namespace fantascope::app
