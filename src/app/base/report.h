#pragma once

#include "core/result.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>

namespace fantascope::app {

// A subcommand's figures, in the order in which they are set. A figure that is not a finite number
// is written as null.
using Report = nlohmann::ordered_json;

// A report as text, and back. What is no UTF-8, such as a name that a stranger sends, is replaced.
// nlohmann-json's own functions are compiled once, in report.cpp. A text that is no JSON gives a
// report that is_discarded().
std::string jsonText(const Report& report);
Report parseJson(const std::string& text);

// Writes `--report FILE.json`: first under another name, then renamed.
Result<void> writeReport(const std::filesystem::path& file, const Report& report);

}  // namespace fantascope::app
