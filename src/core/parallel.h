#pragma once

#include <functional>

namespace fantascope {

// Calls work(0) .. work(count-1), each once, on at most `threads` threads, including the caller's,
// and returns when all are done. Which thread runs which index is unspecified, so work(i) may
// depend only on i; then the result is the same for any number of threads. Creates threads, so it
// is not for the render thread.
void parallelFor(int count, int threads, const std::function<void(int)>& work);

// The number of hardware threads; at least 1.
int hardwareThreads();

}  // namespace fantascope
