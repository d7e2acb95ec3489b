#pragma once

#include "core/result.h"

#include <cstdint>
#include <functional>
#include <string>

namespace fantascope::app {

// Makes frames 0, 1, ... `count` - 1 in order, with a progress bar. A person may pause or end it
// (attendance.h). Returns how many were made. Error: that of `make`.
Result<std::int64_t> makeFrames(const std::string& label, std::int64_t count,
                                const std::function<Result<void>(std::int64_t number)>& make);

// The result for the last line: "30 frames, 1.00 s", or what was kept after an early end.
std::string outcomeOf(std::int64_t made, std::int64_t count, double frameRate);

}  // namespace fantascope::app
