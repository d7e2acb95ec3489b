#pragma once

#include <cstdint>

namespace fantascope {

// How many times this thread has allocated with `new` so far. Libraries written in C, OpenGL's
// among them, are not counted.
std::int64_t allocationsSoFar();

// While one lives, what this thread allocates with `new` ends right before memory that may not be
// touched: whatever writes or reads behind it ends the program, machine code of libraries too,
// which no sanitizer watches. Sizes are multiples of 16 bytes and of the alignment. At most 16 such
// allocations.
class FencedAllocations {
public:
    FencedAllocations();
    ~FencedAllocations();
    FencedAllocations(const FencedAllocations&) = delete;
    FencedAllocations& operator=(const FencedAllocations&) = delete;
};

// While one lives, the machine has no memory left for the other threads: their `new` throws
// std::bad_alloc. One at a time.
class FailingAllocations {
public:
    FailingAllocations();
    ~FailingAllocations();
    FailingAllocations(const FailingAllocations&) = delete;
    FailingAllocations& operator=(const FailingAllocations&) = delete;

    std::int64_t failures() const;  // calls that failed so far
};

}  // namespace fantascope
