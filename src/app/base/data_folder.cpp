#include "app/base/data_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

namespace fantascope::app {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFolders[] = {"assets", "config", "shows"};

bool hasData(const fs::path& folder) {
    return std::ranges::all_of(kFolders, [&](const char* name) {
        std::error_code ignored;
        return fs::is_directory(folder / name, ignored);
    });
}

}  // namespace

Result<fs::path> dataFolder() {
    if (const char* chosen = std::getenv("FANTASCOPE_DATA"); chosen != nullptr && *chosen != '\0') {
        if (hasData(chosen)) return fs::path(chosen);
        return Error(fmt::format(
            "FANTASCOPE_DATA is {}, which has no assets, config and shows; set it to the folder that has them", chosen));
    }
    std::error_code failed;
    const fs::path program = fs::read_symlink("/proc/self/exe", failed);
    for (fs::path folder = program.parent_path(); !failed; folder = folder.parent_path()) {
        for (const fs::path& candidate : {folder, folder / "share/fantascope"})
            if (hasData(candidate)) return candidate;
        if (folder == folder.parent_path()) break;
    }
    return Error(
        fmt::format("the program's own files are missing: no folder above {} has assets, config and shows, or has them in "
                    "share/fantascope; set FANTASCOPE_DATA to the folder that has them",
                    program.string()));
}

}  // namespace fantascope::app
