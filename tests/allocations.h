#pragma once

#include <cstdint>

namespace fantascope {

// How many times this thread has allocated with `new` so far. Libraries written in C, OpenGL's among them, are not counted.
std::int64_t allocationsSoFar();

}  // namespace fantascope
