#pragma once

#include "media/image.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace fantascope {

// Rows of pixels for libraries with vector code. Such code works on whole blocks: it reads and
// writes up to a block beyond a row's last pixel, and some of it skips the last pixels if a row has
// no room for the block. Keeps its memory. Thread: thread-bound.
template <class Pixel>
class PaddedRows {
public:
    // Calls write(std::uint8_t* rows, int stride), which fills all rows of a picture of this size,
    // then copies them to `picture`. `stride`: bytes per row.
    template <class Write>
    void fill(Image<Pixel>& picture, Write write) {
        if (isWhole(picture)) return write(bytesOf(picture.pixels().data()), stride(picture.width()));
        make(picture);
        write(bytesOf(memory_.data()), stride(inMemory_));
        for (int y = 0; y < picture.height(); ++y) std::copy_n(row(y), picture.width(), picture.row(y).begin());
    }

    // Calls read(const std::uint8_t* rows, int stride), which reads all rows of `picture`.
    template <class Read>
    void lend(const Image<Pixel>& picture, Read read) {
        if (isWhole(picture)) return read(bytesOf(picture.pixels().data()), stride(picture.width()));
        make(picture);
        for (int y = 0; y < picture.height(); ++y) std::copy_n(picture.row(y).begin(), picture.width(), row(y));
        read(static_cast<const std::uint8_t*>(bytesOf(memory_.data())), stride(inMemory_));
    }

private:
    static constexpr int kBlock = 64;  // pixels; the widest registers hold 64 bytes, one channel

    struct alignas(64) Block {
        Pixel pixels[kBlock];
    };

    static bool isWhole(const Image<Pixel>& picture) { return picture.width() % kBlock == 0; }
    static int stride(int width) { return width * static_cast<int>(sizeof(Pixel)); }
    static std::uint8_t* bytesOf(void* memory) { return static_cast<std::uint8_t*>(memory); }
    static const std::uint8_t* bytesOf(const void* memory) { return static_cast<const std::uint8_t*>(memory); }

    void make(const Image<Pixel>& picture) {
        const int blocks = picture.width() / kBlock + 1;
        inMemory_ = blocks * kBlock;
        memory_.resize(static_cast<std::size_t>(blocks) * static_cast<std::size_t>(picture.height()));
    }
    Pixel* row(int y) { return memory_[static_cast<std::size_t>(y) * static_cast<std::size_t>(inMemory_ / kBlock)].pixels; }

    std::vector<Block> memory_;
    int inMemory_ = 0;  // pixels of a row with its padding
};

}  // namespace fantascope
