#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <optional>
#include <utility>

namespace fantascope {

// A FIFO queue of at most `kCapacity` values from one writer thread to one reader thread; neither
// ever waits or allocates. Large values are written and read in place: a T that keeps its capacity
// (a vector, an image) costs nothing in steady state.
// Thread: space() and push() from one thread; front(), drop() and pop() from one other.
template <class T, std::size_t kCapacity>
class BoundedQueue {
public:
    explicit BoundedQueue(const T& initial = T{}) { values_.fill(initial); }

    // The place of the next value, or null if the queue is full. It holds an old value: overwrite
    // all of it, then push().
    T* space() {
        const std::size_t tail = tail_.load(std::memory_order_relaxed);
        return tail - head_.load(std::memory_order_acquire) == kCapacity ? nullptr : &values_[tail % kCapacity];
    }
    void push() { tail_.store(tail_.load(std::memory_order_relaxed) + 1, std::memory_order_release); }
    // False if the queue is full; the value is not taken.
    bool push(const T& value) {
        T* const place = space();
        if (place == nullptr) return false;
        *place = value;
        push();
        return true;
    }

    // The oldest value, which stays in the queue until drop(); null if there is none.
    T* front() {
        const std::size_t head = head_.load(std::memory_order_relaxed);
        return head == tail_.load(std::memory_order_acquire) ? nullptr : &values_[head % kCapacity];
    }
    void drop() { head_.store(head_.load(std::memory_order_relaxed) + 1, std::memory_order_release); }
    std::optional<T> pop() {
        T* const oldest = front();
        if (oldest == nullptr) return std::nullopt;
        std::optional<T> value(std::move(*oldest));
        drop();
        return value;
    }

private:
    std::array<T, kCapacity> values_;
    std::atomic<std::size_t> head_ = 0, tail_ = 0;
};

}  // namespace fantascope
