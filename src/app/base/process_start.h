#pragma once

#include "core/clock.h"

#include <optional>

namespace fantascope::app {

// When the kernel started this process, on a clock that is the machine's, to some 10 ms; nothing:
// it does not say.
std::optional<Time> processStart(const Clock& clock);

}  // namespace fantascope::app
