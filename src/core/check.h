#pragma once

#include <string_view>

namespace fantascope {

// Prints the failed condition and its place, then aborts; the service manager restarts the show.
[[noreturn]] void checkFailed(const char* file, int line, const char* condition, std::string_view why);

}  // namespace fantascope

// Checks a promise of our own code. Never for what a file, a device or a user may do wrong: that is
// a Result.
#define FANTASCOPE_CHECK(condition, why) ((condition) ? void(0) : ::fantascope::checkFailed(__FILE__, __LINE__, #condition, why))
