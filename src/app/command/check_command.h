#pragma once

#include "app/base/command.h"

#include "core/result.h"

#include <CLI/CLI.hpp>

#include <filesystem>
#include <optional>
#include <ostream>
#include <vector>

namespace fantascope::app {

struct CheckOptions {
    std::vector<std::filesystem::path> paths;   // shows (a folder or its show.yaml), and whatever else the program reads
    std::optional<std::filesystem::path> site;  // looked at too; every show must find its outputs, fixtures and relays there
};

// Reads every file, and every file that it names, once and as the program would, and prints one
// line on each to `out`: "ok" and what it holds, or what is wrong and where. Error: how many were
// refused.
Result<void> checkFiles(const CheckOptions& options, std::ostream& out);

// fantascope check PATH... [--site SITE]
void addCheckCommand(CLI::App& program, Action& action);

}  // namespace fantascope::app
