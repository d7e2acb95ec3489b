#pragma once

#include "core/result.h"

#include <filesystem>
#include <optional>
#include <ostream>
#include <vector>

namespace fantascope::app {

struct CheckOptions {
    std::vector<std::filesystem::path> paths;   // shows (a folder or its show.yaml), and all other files that the program reads
    std::optional<std::filesystem::path> site;  // checked too; every show must find its outputs, fixtures and relays there
};

// Reads every file, and every file that it names, once and as the program would. It prints a line
// for each to `out`: "ok" and what it holds, or what is wrong and where. Error: how many were
// refused.
Result<void> checkFiles(const CheckOptions& options, std::ostream& out);

}  // namespace fantascope::app
