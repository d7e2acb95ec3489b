#pragma once

#include "show/play/playback.h"
#include "show/site/site.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace fantascope::show {

// The input that a change of a contact asks for, at show time `at`; nothing if the site file gives
// the contact no such action. `bank` and `contact` count as in the site. `witnessed`: the change
// was seen. A state found at the start or after a loss is not witnessed: it enters no cue and
// toggles no blackout. Dark and Light apply nevertheless, because they are states.
// `sides`: the names of the show's side lists.
std::optional<Input> inputFor(const Site& site, std::size_t bank, std::size_t contact, bool closed, bool witnessed, Time at,
                              const std::vector<std::string>& sides = {});

}  // namespace fantascope::show
