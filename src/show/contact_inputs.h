#pragma once

#include "show/playback.h"
#include "show/site/site.h"

#include <cstddef>
#include <optional>

namespace fantascope::show {

// What a movement of a contact in a bank of the site asks for, at show time `at`; nothing for most.
// What nobody saw move, because it was found so at the start or after a loss, is no moment for a
// cue; dark and light are states, and hold however they came about.
std::optional<Input> inputFor(const Site& site, std::size_t bank, std::size_t contact, bool closed, bool witnessed, Time at);

}  // namespace fantascope::show
