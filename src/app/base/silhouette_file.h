#pragma once

#include "core/result.h"
#include "media/image.h"

#include <filesystem>

namespace fantascope::app {

// Reads an artist's silhouette, white on black. Whoever uses it cuts its grey at one half. A
// picture larger than any target may be is refused before it is decoded. Error: names the file,
// which is missing, no PNG or JPEG, too large, or coloured, so that nobody could tell what is
// shadow.
Result<GreyImage> readSilhouette(const std::filesystem::path& file);

// The same for a drawing that work starts from. It warns of likely mistakes. `invert`: the drawing
// is black ink on white, and is inverted here. Error: also if nothing is drawn.
Result<GreyImage> readDrawnSilhouette(const std::filesystem::path& file, bool invert);

}  // namespace fantascope::app
