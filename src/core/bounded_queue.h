#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <optional>
#include <utility>

namespace fantascope {

// A first-in first-out queue of at most `kCapacity` values from one writing thread to one reading thread; neither side ever waits or allocates.
// Thread: push() from one thread, pop() from one other.
template <class T, std::size_t kCapacity>
class BoundedQueue {
public:
    // False if the queue is full: the value was not taken.
    bool push(const T& value) {
        const std::size_t tail = tail_.load(std::memory_order_relaxed);
        if (tail - head_.load(std::memory_order_acquire) == kCapacity) return false;
        values_[tail % kCapacity] = value;
        tail_.store(tail + 1, std::memory_order_release);
        return true;
    }
    std::optional<T> pop() {
        const std::size_t head = head_.load(std::memory_order_relaxed);
        if (head == tail_.load(std::memory_order_acquire)) return std::nullopt;
        std::optional<T> value(std::move(values_[head % kCapacity]));
        head_.store(head + 1, std::memory_order_release);
        return value;
    }

private:
    std::array<T, kCapacity> values_{};
    std::atomic<std::size_t> head_ = 0, tail_ = 0;
};

}  // namespace fantascope
