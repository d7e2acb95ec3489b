#pragma once
// What is noticed about an artist's drawing before hours of work go into its negative, or into
// nothing.

#include "core/result.h"
#include "media/image.h"

#include <filesystem>
#include <string>

namespace fantascope::app {

// Error: it is of one grey all over.
Result<void> checkDrawn(const GreyImage& drawing, const std::filesystem::path& file);

// Whether it is probably dark ink on white paper, where a drawing is light on black: the picture's
// edge and most of its pixels are nearly white, and some are dark.
bool isInkOnPaper(const GreyImage& drawing);

// What is odd about a silhouette, white on black; "" if nothing is. Holes in it that are less
// across than kNarrowest of its height are flaws of the drawing: nobody can stand so that light
// falls through them.
constexpr double kNarrowest = 0.02;
std::string oddHolesIn(const GreyImage& silhouette);

}  // namespace fantascope::app
