#pragma once
// Which channels of a fixture say how much light it gives.

#include "show/site/site.h"

#include <cstddef>
#include <string_view>

namespace fantascope::show {

// Whether a channel of this name is the strength of a colour.
bool isColour(std::string_view channel);
// Whether a fixture's light is proportional to a channel: to its intensity, or if it has none to
// each of its colours.
bool scalesLight(const Fixture& fixture, std::size_t channel);

}  // namespace fantascope::show
