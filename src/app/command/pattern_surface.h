#pragma once

#include "core/result.h"
#include "media/image.h"

#include <memory>
#include <string>

namespace fantascope::app {

// What a pattern is to be seen on, as PatternSearch::Options has it. `place`: SITE:OUTPUT. `guide`:
// in linear light; the picture lies on the output's canvas as a source's picture does by default.
// White is chosen so that the surface lacks a hundredth of the guide's light. Error: no such site
// or output; it has no survey that fits.
Result<std::shared_ptr<const GreyImage>> readPatternSurface(const std::string& place, const GreyImage& guide);

}  // namespace fantascope::app
