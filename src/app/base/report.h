#pragma once

#include "core/result.h"

#include <nlohmann/json.hpp>

#include <filesystem>

namespace fantascope::app {

// A subcommand's figures, in the order in which they are set. A figure that is not a finite number
// is written as null.
using Report = nlohmann::ordered_json;

// Writes `--report FILE.json`: first under another name, then renamed.
Result<void> writeReport(const std::filesystem::path& file, const Report& report);

}  // namespace fantascope::app
