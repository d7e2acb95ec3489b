#pragma once

#include <cstdint>
#include <vector>

namespace fantascope::pattern {

// How many instances lie on each pixel, 0 .. 65535, in bit planes: a word of plane k holds bit k of
// 64 neighbouring counts. So adding or removing an instance takes a few operations per word, with a
// carry from plane to plane, and none per pixel.
class LayerCounts {
public:
    static constexpr int kPlanes = 16, kMax = (1 << kPlanes) - 1;

    explicit LayerCounts(std::size_t words);

    // The pixels of a word with exactly three instances.
    std::uint64_t three(std::size_t word) const { return planes_[0][word] & planes_[1][word] & ~above(word, 2); }
    // Adds or removes one instance on the pixels of `mask`; remove() needs one on each.
    void add(std::size_t word, std::uint64_t mask);
    void remove(std::size_t word, std::uint64_t mask);

private:
    // The pixels with a bit in plane `first` or beyond.
    std::uint64_t above(std::size_t word, std::size_t first) const {
        std::uint64_t any = 0;
        for (std::size_t plane = first; plane < planes_.size(); ++plane) any |= planes_[plane][word];
        return any;
    }
    std::vector<std::vector<std::uint64_t>> planes_;  // as many as were needed so far
};

}  // namespace fantascope::pattern
