#include "app/base/temporary_folder.h"

#include <cstdlib>
#include <system_error>

namespace fantascope::app {

Result<TemporaryFolder> TemporaryFolder::make() {
    std::error_code failed;
    std::string name = (std::filesystem::temp_directory_path(failed) / "fantascope-XXXXXX").string();
    if (failed || ::mkdtemp(name.data()) == nullptr) return Error(name + ": this folder cannot be made");
    return TemporaryFolder(name);
}

TemporaryFolder::~TemporaryFolder() {
    std::error_code ignored;
    if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
}

}  // namespace fantascope::app
