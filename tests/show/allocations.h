#pragma once

#include <cstddef>

namespace fantascope {

// How often this program has asked the heap for memory so far, on all threads.
std::size_t allocations();

}  // namespace fantascope
