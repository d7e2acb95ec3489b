#include "allocations.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>

namespace {

constexpr std::size_t kAlignment = 16;

thread_local std::int64_t allocations = 0;
thread_local bool isFenced = false;

// Set by FailingAllocations.
std::atomic<bool> othersFail = false;
std::atomic<std::int64_t> failed = 0;  // calls
thread_local bool isSpared = false;

bool hasFailed() {
    if (!othersFail || isSpared) return false;
    ++failed;
    return true;
}

struct Fenced {
    std::atomic<void*> memory = nullptr;
    void* pages = nullptr;
    std::size_t length = 0;
};
std::array<Fenced, 16> fenced;
std::atomic<int> fencedCount = 0;

void* allocateFenced(std::size_t bytes, std::size_t alignment) {
    constexpr std::size_t kFence = 1 << 16;
    const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
    const std::size_t room = (bytes + page - 1) / page * page, length = room + kFence;
    for (Fenced& one : fenced) {
        if (one.memory != nullptr) continue;
        auto* const pages =
            static_cast<std::byte*>(::mmap(nullptr, length, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0));
        if (bytes % alignment != 0 || pages == MAP_FAILED || ::mprotect(pages + room, kFence, PROT_NONE) != 0) std::abort();
        one.pages = pages;
        one.length = length;
        one.memory = pages + room - bytes;
        ++fencedCount;
        return one.memory;
    }
    std::abort();
}

bool freeFenced(void* memory) {
    if (fencedCount == 0 || memory == nullptr) return false;
    for (Fenced& one : fenced) {
        if (one.memory != memory) continue;
        ::munmap(one.pages, one.length);
        one.memory = nullptr;
        --fencedCount;
        return true;
    }
    return false;
}

void release(void* memory) {
    if (!freeFenced(memory)) std::free(memory);
}

}  // namespace

// These replace the standard library's for the whole test program.
void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept {
    ++allocations;
    if (hasFailed()) return nullptr;
    return isFenced ? allocateFenced(bytes, kAlignment) : std::malloc(bytes);
}
void* operator new(std::size_t bytes) {
    if (void* memory = operator new(bytes, std::nothrow)) return memory;
    throw std::bad_alloc();
}
void* operator new(std::size_t bytes, std::align_val_t asked) {
    ++allocations;
    if (hasFailed()) throw std::bad_alloc();
    const std::size_t alignment = std::max(static_cast<std::size_t>(asked), kAlignment);
    if (isFenced) return allocateFenced(bytes, alignment);
    void* memory = nullptr;
    if (::posix_memalign(&memory, alignment, bytes) != 0) throw std::bad_alloc();
    return memory;
}
void operator delete(void* memory) noexcept { release(memory); }
void operator delete(void* memory, std::size_t) noexcept { release(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { release(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { release(memory); }

std::int64_t fantascope::allocationsSoFar() { return allocations; }

fantascope::FencedAllocations::FencedAllocations() { isFenced = true; }
fantascope::FencedAllocations::~FencedAllocations() { isFenced = false; }

fantascope::FailingAllocations::FailingAllocations() {
    isSpared = true;
    failed = 0;
    othersFail = true;
}
fantascope::FailingAllocations::~FailingAllocations() {
    othersFail = false;
    isSpared = false;
}
std::int64_t fantascope::FailingAllocations::failures() const { return failed; }
