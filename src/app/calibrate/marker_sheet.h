#pragma once

#include "core/result.h"

#include <filesystem>
#include <vector>

namespace fantascope::app {

// Writes the sheets of the four corner markers (vision/corner_markers.h), A4: a PDF or SVG in true
// size, or a PNG. They are named after `file` and their corners: markers-top-left.pdf. Returns the
// files. Error: another ending, or a file cannot be written.
Result<std::vector<std::filesystem::path>> writeMarkerSheets(const std::filesystem::path& file);

}  // namespace fantascope::app
