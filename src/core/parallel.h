#pragma once

#include <functional>

namespace fantascope {

// Calls work(0) .. work(count-1), each once, on at most `threads` threads (the caller's is one of
// them), and returns when all are done. Which thread runs which index is open, so work(i) may
// depend on i alone: then any thread count gives the same result. Threads are made for the call;
// not for the render thread. An exception out of `work` goes on to the caller once all are done.
void parallelFor(int count, int threads, const std::function<void(int)>& work);

// How many threads this machine offers; at least 1.
int hardwareThreads();

}  // namespace fantascope
