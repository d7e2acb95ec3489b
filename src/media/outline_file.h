#pragma once

#include "core/result.h"
#include "media/outline.h"

#include <filesystem>

namespace fantascope {

// Whether readOutline() accepts the file by its extension: an SVG, or a picture that media/image.h
// reads.
bool isOutlineFile(const std::filesystem::path& path);

// The outline of an SVG or a picture, smooth to a fraction of a pixel, with at most about 80
// points, in shares of the picture's longer side. If a part is transparent, the rest is the region;
// otherwise the region is what is lighter or darker than most of the border. Specks are left out.
// Error: names the file: unreadable, of one colour, without area, or too intricate.
Result<Outline> readOutline(const std::filesystem::path& path);

}  // namespace fantascope
