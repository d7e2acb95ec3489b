#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <memory>
#include <mutex>
#include <utility>

namespace fantascope {

// An append-only log. Any number of threads append; any number of readers each see every value,
// once, all in the same order. A reader never waits, never allocates, and misses nothing however
// late it reads. Values stay until the log is destroyed, so it is meant for a few values per
// second.
// Thread: append() from any thread; a Reader belongs to one thread at a time. The log outlives its
// readers.
template <class T>
class AppendLog {
    static constexpr std::size_t kChunk = 256;
    struct Chunk {
        std::array<T, kChunk> values{};
        std::atomic<std::size_t> count = 0;  // of readable values
        std::atomic<Chunk*> next = nullptr;
    };

public:
    class Reader {
    public:
        // The next value, which stays in place; null: none yet.
        const T* next() {
            if (read_ == kChunk) {
                const Chunk* const next = chunk_->next.load(std::memory_order_acquire);
                if (next == nullptr) return nullptr;
                chunk_ = next;
                read_ = 0;
            }
            return read_ < chunk_->count.load(std::memory_order_acquire) ? &chunk_->values[read_++] : nullptr;
        }

        // Whether next() would give one.
        bool hasNext() const {
            const Chunk* const chunk = read_ == kChunk ? chunk_->next.load(std::memory_order_acquire) : chunk_;
            return chunk != nullptr && chunk->count.load(std::memory_order_acquire) > (read_ == kChunk ? 0 : read_);
        }

    private:
        friend AppendLog;
        explicit Reader(const Chunk* chunk) : chunk_(chunk) {}
        const Chunk* chunk_;
        std::size_t read_ = 0;  // in chunk_
    };

    AppendLog() : first_(new Chunk), last_(first_) {}
    ~AppendLog() {
        for (const Chunk* chunk = first_; chunk != nullptr;)
            delete std::exchange(chunk, chunk->next.load(std::memory_order_relaxed));
    }
    AppendLog(const AppendLog&) = delete;
    AppendLog& operator=(const AppendLog&) = delete;

    // Waits only for other writers.
    void append(T value) {
        const std::lock_guard lock(writing_);
        std::size_t count = last_->count.load(std::memory_order_relaxed);
        if (count == kChunk) {
            auto chunk = std::make_unique<Chunk>();
            last_->next.store(chunk.get(), std::memory_order_release);
            last_ = chunk.release();
            count = 0;
        }
        last_->values[count] = std::move(value);
        last_->count.store(count + 1, std::memory_order_release);
    }

    // Starts at the first value, whenever it is made.
    Reader reader() const { return Reader(first_); }

private:
    Chunk* const first_;
    std::mutex writing_;  // guards:
    Chunk* last_;
};

}  // namespace fantascope
