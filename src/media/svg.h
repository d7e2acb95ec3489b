#pragma once

#include "core/result.h"
#include "media/image.h"

#include <filesystem>

namespace fantascope {

// An SVG's drawing, cropped to its bounding box, the longer side `side` pixels. Files that it
// refers to are not loaded.
// Error: names the file: unreadable, not an SVG, or an empty drawing.
Result<RgbaImage> readSvg(const std::filesystem::path& path, int side);

}  // namespace fantascope
