#pragma once

#include "pattern/search/search_space.h"

#include "core/random.h"

#include <glm/vec2.hpp>

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

namespace fantascope::pattern {

// The pixels of one instance, 64 neighbours of a row in a word: the words of the rectangle around
// it, column by column.
class PixelMask {
public:
    static constexpr int kBits = 64;

    // Nothing.
    void clear() { left_ = right_ = top_ = bottom_ = 0; }
    // What the scanner draws of an instance.
    void draw(SilhouetteScanner& scanner, const Silhouette& shape, const InstancePose& pose);

    bool empty() const { return left_ == right_; }
    int left() const { return left_; }  // columns of words, from `left` to before `right`
    int right() const { return right_; }
    int top() const { return top_; }  // rows
    int bottom() const { return bottom_; }
    // One column of words, whether it lies in the rectangle or not: at any row, 0 outside.
    struct Column {
        const std::uint64_t* words = nullptr;
        int top = 0;
        unsigned rows = 0;
        std::uint64_t at(int y) const {
            const auto row = static_cast<unsigned>(y - top);
            return row < rows ? words[row] : 0;
        }
    };
    Column column(int index) const {
        if (index < left_ || index >= right_) return {};
        const auto rows = static_cast<unsigned>(bottom_ - top_);
        return {words_.data() + static_cast<std::size_t>(index - left_) * rows, top_, rows};
    }
    std::int64_t count() const;
    // One of its pixels, all equally likely; it must have some.
    glm::ivec2 randomPixel(Rng& rng) const;

private:
    struct Run {
        int y, begin, end;
    };
    std::vector<Run> runs_;  // scratch, kept for its memory
    std::vector<std::uint64_t> words_;
    int left_ = 0, right_ = 0, top_ = 0, bottom_ = 0;
};

// How many instances lie on each pixel, in bit planes: bit k of 64 neighbouring counts is one word,
// so that an instance comes and goes by a few operations on words, with a carry from plane to
// plane, instead of one on every pixel. Counts up to 65535.
class LayerCounts {
public:
    static constexpr int kPlanes = 16, kMost = (1 << kPlanes) - 1;

    explicit LayerCounts(std::size_t words);

    // Of the pixels of a word: those with just three instances.
    std::uint64_t three(std::size_t word) const { return planes_[0][word] & planes_[1][word] & ~above(word, 2); }
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

// A pattern that is judged move by move: what one instance more or less would change is known from
// its own pixels alone. All sums are whole numbers; after any number of moves they are those of a
// fresh drawing.
//
// What is held against the guide I, with I' the pattern white on black, in pixels of full
// difference:
//   detail   z = sum |I - I'|, the paper's goal (section 4.1), less what the tone sees better: where the guide is black or white
//   a covered
//            pixel adds 1 - 2 I, as in z; where it is grey, for which z would have black or white too, only a quarter of what 1 -
//            2 I differs from its mean around, which keeps the edges of greys.
//   tone     sum |G*I - G*I'|, the mean for two Gaussians G of sigma height/36 and height/18: what remains when the eye blurs
//   overlap  the pixels that several instances cover; where the guide is white, as far as they are more than a given share of
//   those that any
//            covers
//
// Thread: thread-bound.
class RunningScore {
public:
    explicit RunningScore(const SearchSpace& space);

    // The change of the weighted sum if `out` (an instance that is drawn, or nothing) went and `in`
    // came instead; if it is more than `most`, something above `most` that took less to find.
    // Nothing changes yet.
    double propose(const PixelMask& out, const PixelMask& in, double most = std::numeric_limits<double>::infinity());
    // Makes the change that was proposed last, with the same masks.
    void accept(const PixelMask& out, const PixelMask& in);

    double z() const;           // mean, 0..1
    GreyImage picture() const;  // the pattern white on black

    // Looks where light is lacking, in the search's region if it has one. What the next one gives
    // is of this moment until it is called again.
    void findDarkPlaces();
    // A pixel without light in a block that lacks light, as does its surrounding, the likelier the
    // more; any pixel where none does.
    glm::ivec2 darkPlace(Rng& rng) const;

private:
    // Everything that a move asks of 64 pixels, side by side in memory; the words of a column are
    // neighbours.
    struct Word {
        std::uint64_t none, one, two;  // the pixels with no instance, with just one, with just two
        std::uint64_t white;           // of the guide
        // Of each pixel, where it is the same for all: what covering it adds to the detail, in 1 /
        // kPull, and to sum |I - I'|, in Goal's units.
        std::int32_t pull, cost;
        std::int32_t pulls;  // else the index in pulls_; -1
    };
    // What changes is counted in square blocks. Those of 8 pixels, which all but small pictures
    // have, are counted together: the counts of a word's eight blocks are its bytes.
    static constexpr int kLargestBlock = 8, kScales = 2;
    struct Change {
        glm::ivec2 block;
        std::int32_t pixels;
        std::int32_t part;  // of the two masks' difference: those far from each other are spread apart
    };
    // A rectangle of nodes, ends included.
    struct Box {
        glm::ivec2 least{std::numeric_limits<int>::max()}, most{-1};
        bool empty() const { return most.x < 0; }
        void add(glm::ivec2 node) { least = glm::min(least, node), most = glm::max(most, node); }
    };
    // One Gaussian, sampled at nodes a little closer than its sigma. All values are whole numbers,
    // in doubles.
    struct Scale {
        glm::ivec2 nodes{0};
        std::vector<std::int32_t> columns,
            rows;  // which node's each column and row of blocks is; each has a square of blocks around it
        glm::ivec2 nodeOf(glm::ivec2 block) const {
            return {columns[static_cast<std::size_t>(block.x)], rows[static_cast<std::size_t>(block.y)]};
        }
        std::size_t at(glm::ivec2 node) const {
            return static_cast<std::size_t>(node.y) * static_cast<std::size_t>(nodes.x) + static_cast<std::size_t>(node.x);
        }
        std::vector<double> lack;    // of each node: the Gaussian mean of I - I', in Goal's units * kKernelSum^2
        std::vector<double> change;  // pixels covered more by the move at hand, in each square; zero between moves
        std::array<Box, 2> touched;  // where they are
        std::vector<double> spread;  // the changes of `lack` by the move at hand, box by box
    };
    std::size_t wordAt(int column, int y) const {
        return static_cast<std::size_t>(column) * static_cast<std::size_t>(height_) + static_cast<std::size_t>(y);
    }
    void measureGuide();
    void measureDetail();
    std::int64_t pullOf(const Word& word, std::uint64_t pixels) const;
    void noteBlocks(int column, int row, std::uint64_t covered, std::uint64_t freed, int part);
    double overlap(std::int64_t coveredWhite, std::int64_t severalWhite) const;
    double toneChange();
    void gather(Scale& scale);
    double spreadChange(Scale& scale, const Box& box);

    const SearchSpace& space_;
    const std::optional<PatternSearch::Region> region_;
    const int width_, height_;
    const int block_;          // the side of a block, pixels: 1, 2, 4 or 8
    const int blockShift_;     // its logarithm to base 2
    const glm::ivec2 blocks_;  // so many, those cut by the edges included
    LayerCounts counts_;
    std::vector<Word> words_;
    // The pulls of 64 pixels, each + kOffset, in bit planes: a sum over any of them is a few counts
    // of bits.
    static constexpr int kPull = 63, kOffset = 64, kPullPlanes = 7;
    std::vector<std::array<std::uint64_t, kPullPlanes>> pulls_;
    std::vector<std::int64_t> lack_;  // of each block: sum I - I', in Goal's units
    std::array<Scale, kScales> scales_;

    std::int64_t sum_ = 0;                              // |I - I'| in Goal's units
    std::int64_t coveredWhite_ = 0, severalWhite_ = 0;  // white pixels with an instance, with several
    // By the move at hand.
    std::int64_t coveredWhiteChange_ = 0, severalWhiteChange_ = 0;
    std::vector<Change> blockChanges_;
    std::vector<double> row_;  // scratch

    std::vector<std::int64_t> darkness_;  // running sums over the blocks
};

}  // namespace fantascope::pattern
