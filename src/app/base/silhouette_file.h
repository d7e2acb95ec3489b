#pragma once

#include "core/result.h"
#include "media/image.h"

#include <filesystem>

namespace fantascope::app {

// An artist's silhouette, white on black; its grey is cut at a half where it is used. Refused
// before it is decoded if no target may be so large. Error: names the file: missing, no PNG or
// JPEG, too large, or in colours, of which nobody could say which are shadow.
Result<GreyImage> readSilhouette(const std::filesystem::path& file);

// The same of a drawing that work begins with. Warns of what looks like a mistake. `invert`: it is
// black ink on white, and turned over here.
// Error: also nothing is drawn.
Result<GreyImage> readDrawnSilhouette(const std::filesystem::path& file, bool invert);

}  // namespace fantascope::app
