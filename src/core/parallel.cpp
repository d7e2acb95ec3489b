#include "core/parallel.h"

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

namespace fantascope {

void parallelFor(int count, int threads, const std::function<void(int)>& work) {
    std::atomic<int> next = 0;
    const auto worker = [&] {
        for (int index = next++; index < count; index = next++) work(index);
    };
    std::vector<std::jthread> helpers;
    for (int i = 1; i < std::min(threads, count); ++i) helpers.emplace_back(worker);
    worker();
}

int hardwareThreads() { return static_cast<int>(std::max(1u, std::thread::hardware_concurrency())); }

}  // namespace fantascope
