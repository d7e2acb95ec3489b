#pragma once

#include "core/result.h"
#include "media/image.h"

#include <filesystem>

namespace fantascope {

// What an SVG draws on its page, cut to the box around it, its longer side `side` pixels. Files
// that it refers to are not looked for.
// Error: names the file: unreadable, not an SVG, or drawing nothing.
Result<RgbaImage> readSvg(const std::filesystem::path& path, int side);

}  // namespace fantascope
