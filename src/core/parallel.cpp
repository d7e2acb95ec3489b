#include "core/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace fantascope {

void parallelFor(int count, int threads, const std::function<void(int)>& work) {
    std::atomic<int> next = 0;
    std::mutex mutex;
    std::exception_ptr failure;
    const auto worker = [&] {
        try {
            for (int index = next++; index < count; index = next++) work(index);
        } catch (...) {
            next = count;  // what is left would be in vain
            const std::lock_guard lock(mutex);
            if (!failure) failure = std::current_exception();
        }
    };
    {
        std::vector<std::jthread> helpers;
        try {
            for (int i = 1; i < std::min(threads, count); ++i) helpers.emplace_back(worker);
        } catch (const std::system_error&) {  // the system gives no further thread; those that are there do it all
        }
        worker();
    }
    if (failure) std::rethrow_exception(failure);
}

int hardwareThreads() { return static_cast<int>(std::max(1u, std::thread::hardware_concurrency())); }

}  // namespace fantascope
