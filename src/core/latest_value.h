#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace fantascope {

// A slot for the newest value, from one writer thread to one reader thread. Unread values are
// overwritten. Neither thread ever waits or allocates: three buffers are made once and reused, so a
// T that keeps its capacity (a vector, an image) costs nothing in steady state.
// Thread: writable() and publish() from one thread; update() and value() from one other.
template <class T>
class LatestValue {
public:
    explicit LatestValue(const T& initial = T{}) : buffers_{initial, initial, initial} {}

    // The writer's own buffer. It holds an old value: overwrite all of it, then publish().
    T& writable() { return buffers_[writer_]; }
    void publish() { writer_ = middle_.exchange(writer_ | kFresh, std::memory_order_acq_rel) & kIndex; }

    // Takes the newest value if it is new; returns whether it was. value() does not change
    // otherwise.
    bool update() {
        if (!(middle_.load(std::memory_order_relaxed) & kFresh)) return false;
        reader_ = middle_.exchange(reader_, std::memory_order_acq_rel) & kIndex;
        return true;
    }
    const T& value() const { return buffers_[reader_]; }

private:
    static constexpr std::uint8_t kIndex = 3, kFresh = 4;
    std::array<T, 3> buffers_;
    std::uint8_t writer_ = 0;
    std::atomic<std::uint8_t> middle_ = 1;
    std::uint8_t reader_ = 2;
};

}  // namespace fantascope
