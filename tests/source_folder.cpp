#include "source_folder.h"

namespace fantascope {

std::string sourceFolder() { return FANTASCOPE_SOURCE_DIR; }

}  // namespace fantascope
