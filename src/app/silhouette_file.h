#pragma once

#include "core/image.h"
#include "core/result.h"

#include <filesystem>

namespace fantascope::app {

// An artist's silhouette, white on black; its grey is cut at a half where it is used. Refused before it is decoded if no target may be so
// large. Error: names the file: missing, no PNG or JPEG, too large, or in colours, of which nobody could say which are shadow.
Result<GreyImage> readSilhouette(const std::filesystem::path& file);

}  // namespace fantascope::app
