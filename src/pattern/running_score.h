#pragma once

#include "pattern/search_space.h"

#include "core/random.h"

#include <glm/vec2.hpp>

#include <array>
#include <cstdint>
#include <vector>

namespace fantascope::pattern {

// The pixels of one instance: x from `begin` to before `end` in row y. No pixel is in two runs of an instance.
struct PixelRun {
    int y, begin, end;
};
using PixelRuns = std::vector<PixelRun>;

// How many instances lie on each pixel, in bit planes: bit k of 64 neighbouring counts is one word, so that an instance comes and goes
// by a few operations on words, with a carry from plane to plane, instead of one on every pixel. Counts up to 65535.
class LayerCounts {
public:
    static constexpr int kBits = 64, kPlanes = 16, kMost = (1 << kPlanes) - 1;

    explicit LayerCounts(std::size_t words);

    // Of the pixels of a word: those with no instance, with just one, with just two.
    std::uint64_t none(std::size_t word) const { return ~above(word, 0); }
    std::uint64_t one(std::size_t word) const { return planes_[0][word] & ~above(word, 1); }
    std::uint64_t two(std::size_t word) const { return planes_[1][word] & ~planes_[0][word] & ~above(word, 2); }
    // One more, or one less, on the pixels of a mask; there must be one to take.
    void add(std::size_t word, std::uint64_t mask);
    void take(std::size_t word, std::uint64_t mask);

private:
    // The pixels with a bit in plane `first` or beyond.
    std::uint64_t above(std::size_t word, std::size_t first) const {
        std::uint64_t any = 0;
        for (std::size_t plane = first; plane < planes_.size(); ++plane) any |= planes_[plane][word];
        return any;
    }
    std::vector<std::vector<std::uint64_t>> planes_;  // those that were needed so far
};

// A pattern that is judged move by move: what one instance more or less would change is known from its own pixels alone. All sums are
// whole numbers; after any number of moves they are those of a fresh drawing.
//
// What is held against the guide I, with I' the pattern white on black, in pixels of full difference:
//   z        sum |I - I'|, the paper's goal (section 4.1)
//   tone     the mean over three scales of sum |cell's I - cell's I'|, over square cells of height/22 to height/5: what remains when the
//            eye blurs. The lattice of cells is moved at random now and then, so that it does not show in the pattern.
//   overlap  the pixels that several instances cover
//
// Thread: thread-bound.
class RunningScore {
public:
    explicit RunningScore(const SearchSpace& space);

    // The change of the weighted sum if `out` (the runs of an instance that is drawn, or none) went and `in` came instead. The
    // move is then half done: accept() or reject() it with the same runs.
    double propose(const PixelRuns& out, const PixelRuns& in);
    void accept(const PixelRuns& in);
    void reject(const PixelRuns& out);

    // Moves the lattice of the tone. Needed once before the first move.
    void jitter(Rng& rng);

    double z() const;  // mean, 0..1
    // Whether the place lacks light: the pixel is dark and its surrounding darker than in the guide.
    bool lacksLight(glm::ivec2 pixel) const;

private:
    static constexpr std::array<int, 3> kScales = {2, 4, 9};  // sides of cells in blocks
    struct Scale {
        std::vector<std::int32_t> cellOf;     // of each block
        std::vector<std::int64_t> lack;       // of each cell: sum I - I', in Goal's units
        std::vector<std::int32_t> change;     // of its covered pixels in the move at hand; zero between moves
        std::vector<std::int64_t> touchedIn;  // the last move that touched the cell
        std::vector<std::int32_t> touched;    // the cells of the move at hand, each once
    };
    // Words stand in columns, so that an instance's words are neighbours in memory: the inner loop waits for little else.
    std::size_t wordAt(int x, int y) const;
    template <class Use>
    void forEachWord(const PixelRuns& runs, Use use);
    std::int64_t costOf(std::size_t word, std::uint64_t pixels) const;
    void noteCovered(std::size_t word, int y, int first, std::uint64_t pixels, int sign);
    double toneChange();

    const SearchSpace& space_;
    const int width_, height_;
    const int block_;    // the side of a block, pixels
    glm::ivec2 blocks_;  // so many, the ones cut by the edges included
    LayerCounts counts_;
    // Of each word: what covering the first 0, 1, ... 64 of its pixels would add to sum |I - I'|, in Goal's units.
    std::vector<std::array<std::int32_t, LayerCounts::kBits + 1>> costs_;
    std::vector<std::int32_t> columnOf_, columnEnds_;  // the block column of each x, and the first x after each column
    std::vector<std::int32_t> rowOf_;                  // the first block of the block row of each y
    std::array<Scale, kScales.size()> scales_;

    std::int64_t sum_ = 0;  // |I - I'| in Goal's units
    // The move at hand.
    std::int64_t move_ = 0, sumChange_ = 0;
    std::vector<std::int32_t> blockChange_;  // zero between moves
    std::vector<std::int32_t> touchedBlocks_;
};

}  // namespace fantascope::pattern
