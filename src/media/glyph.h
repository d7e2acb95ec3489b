#pragma once

#include "core/result.h"
#include "media/outline.h"

namespace fantascope {

// The outline of a character in DejaVu Sans Bold, from Debian's fonts-dejavu-core; an em is 1.
// Error: the font is not installed, has no such character, or draws nothing for it.
Result<Outline> glyphOutline(char32_t character);

}  // namespace fantascope
