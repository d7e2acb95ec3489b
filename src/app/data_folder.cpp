#include "app/data_folder.h"

#include <cstdlib>

namespace fantascope::app {

std::filesystem::path dataFolder() {
    const char* chosen = std::getenv("FANTASCOPE_DATA");
    return chosen != nullptr && *chosen != '\0' ? chosen : FANTASCOPE_SOURCE_DIR;
}

}  // namespace fantascope::app
