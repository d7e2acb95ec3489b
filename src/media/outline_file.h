#pragma once

#include "core/result.h"
#include "media/outline.h"

#include <filesystem>

namespace fantascope {

// The files that readOutline takes for what they are, by their ending: an SVG, or a picture that
// core/image.h reads.
bool isOutlineFile(const std::filesystem::path& path);

// The outline of what an SVG or a picture shows, smooth to a fraction of a pixel and of some 80
// points at most, in shares of the picture's longer side. If a part of it is transparent, the rest
// is the region; otherwise what is lighter or darker than most of the border. Specks are left out.
// Error: names the file: unreadable, of one colour, nothing that has an area, or too intricate.
Result<Outline> readOutline(const std::filesystem::path& path);

}  // namespace fantascope
