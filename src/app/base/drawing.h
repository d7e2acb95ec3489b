#pragma once
// Checks of an artist's drawing, before hours of work go into its negative or into an empty page.

#include "core/result.h"
#include "media/image.h"

#include <filesystem>
#include <string>

namespace fantascope::app {

// Error: the drawing has one grey everywhere.
Result<void> checkDrawn(const GreyImage& drawing, const std::filesystem::path& file);

// Whether the drawing is probably dark ink on white paper instead of light on black: the picture's
// edge and most of its pixels are nearly white, and some are dark.
bool isInkOnPaper(const GreyImage& drawing);

// What is odd about a silhouette, white on black; "" if nothing is. Holes narrower than kNarrowest
// of its height are flaws of the drawing: no people can leave such gaps.
constexpr double kNarrowest = 0.02;
std::string oddHolesIn(const GreyImage& silhouette);

}  // namespace fantascope::app
