#pragma once

#include <cstdint>

namespace fantascope {

// How many times this thread has opened a file so far, by whatever library: open, openat, creat,
// fopen and their kin.
std::int64_t filesOpenedSoFar();
// How many times it has made memory executable, as a just-in-time compiler does with what it
// compiled: llvmpipe, for each new combination of shader and state.
std::int64_t compilationsSoFar();
// How many times it gave up the processor by itself: it waited for a lock, another thread, a disk,
// a network or a clock.
std::int64_t waitsSoFar();

}  // namespace fantascope
