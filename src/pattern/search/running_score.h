#pragma once

#include "pattern/search/layer_counts.h"
#include "pattern/search/pixel_mask.h"
#include "pattern/search/search_space.h"

#include "core/random.h"

#include <glm/vec2.hpp>

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

namespace fantascope::pattern {

// The goal of the refined method, kept up to date move by move: what a move changes is computed
// from the pixels of one instance. All sums are integers, so after any number of moves they equal
// those of a fresh drawing.
//
// Its terms, with I the guide and I' the pattern white on black, in pixels of full difference:
//   detail   The paper's goal, z = sum |I - I'| (section 4.1), less what the tone measures better.
//            Where the guide is black or white, covering a pixel adds 1 - 2 I, as in z. Where it is
//            grey, z alone would favour black or white; so covering a pixel adds only a quarter of
//            the difference of 1 - 2 I from its local mean. This preserves the edges of greys.
//   tone     sum |G*I - G*I'|, the mean for two Gaussians G of sigma height/36 and height/18: the
//            difference that remains when the eye blurs.
//   overlap  The number of pixels that several instances cover. Where the guide is white, only the
//            part above a given share of all covered pixels counts.
//
// On a surface that is not evenly white, I' is what is seen: a covered pixel gives the surface's
// light there. The tone takes that light as even over a block of a few pixels.
//
// Thread: thread-bound.
class RunningScore {
public:
    explicit RunningScore(const SearchSpace& space);

    // The change of the weighted sum if `out` (a drawn instance, or empty) were replaced by `in`
    // (or empty). If the change exceeds `limit`, it may return a lower bound of it that exceeds
    // `limit` too and takes less time. Changes nothing yet.
    double propose(const PixelMask& out, const PixelMask& in, double limit = std::numeric_limits<double>::infinity());
    // Makes the change of the last propose(), which had the same masks.
    void accept(const PixelMask& out, const PixelMask& in);

    double z() const;           // mean |I - I'|, 0..1
    GreyImage picture() const;  // I'

    // Finds where light is lacking, in the search's region if it has one. darkPlace() uses the
    // result until the next call.
    void findDarkPlaces();
    // A random dark pixel in a block that lacks light and whose neighbourhood does, with a
    // probability proportional to the lack. Any pixel if there is no such block.
    glm::ivec2 darkPlace(Rng& rng) const;

private:
    // Everything that a move needs to know of 64 pixels, together in memory. The words of a column
    // are contiguous.
    struct Word {
        std::uint64_t none, one, two;  // the pixels with no, exactly one, exactly two instances
        std::uint64_t white;           // pixels that are white in the guide
        // If they are the same for all pixels: what covering one adds to the detail, in 1 / kPull,
        // and to sum |I - I'|, in Goal's units.
        std::int32_t pull, cost;
        std::int32_t pulls;  // otherwise the index in pulls_, else -1
    };
    // Changes are counted in square blocks. Those of 8 pixels are counted together: the counts of a
    // word's eight blocks are the bytes of one word.
    static constexpr int kLargestBlock = 8, kScales = 2;
    static int blockFor(int height);
    struct BlockChange {
        glm::ivec2 block;
        std::int32_t light;  // of the pixels that are covered more, in 1 / kLightSteps
        std::int32_t part;   // 0 or 1: masks far from each other are spread separately
    };
    // What a move changes, but for the blocks.
    struct Change {
        std::int64_t detail = 0;                          // in 1 / kPull
        std::int64_t several = 0;                         // pixels with several instances
        std::int64_t coveredWhite = 0, severalWhite = 0;  // white pixels with at least one, with several
    };
    // Columns of words left <= column < right, rows top <= y < bottom.
    struct Window {
        int left, right, top, bottom;
    };
    // A rectangle of nodes, including `low` and `high`.
    struct Box {
        glm::ivec2 low{std::numeric_limits<int>::max()}, high{-1};
        bool empty() const { return high.x < 0; }
        void add(glm::ivec2 node) { low = glm::min(low, node), high = glm::max(high, node); }
    };
    // One Gaussian, sampled at nodes a little closer than its sigma. All values are integers,
    // stored as doubles.
    struct Scale {
        glm::ivec2 nodes{0};
        // The node of each column and row of blocks; each node has a square of blocks around it.
        std::vector<std::int32_t> columns, rows;
        glm::ivec2 nodeOf(glm::ivec2 block) const {
            return {columns[static_cast<std::size_t>(block.x)], rows[static_cast<std::size_t>(block.y)]};
        }
        std::size_t at(glm::ivec2 node) const {
            return static_cast<std::size_t>(node.y) * static_cast<std::size_t>(nodes.x) + static_cast<std::size_t>(node.x);
        }
        std::vector<double> lack;    // per node: the Gaussian mean of I - I', in Goal's units * kKernelSum^2
        std::vector<double> change;  // per node: the light that the current move adds, in white pixels; zero between moves
        std::array<Box, 2> touched;  // the nodes with changes, by part
        std::vector<double> spread;  // the changes of `lack` by the current move, box by box
    };
    std::size_t wordAt(int column, int y) const {
        return static_cast<std::size_t>(column) * static_cast<std::size_t>(height_) + static_cast<std::size_t>(y);
    }
    void measureSurface();
    void measureGuide();
    void measureDetail();
    std::int64_t pullOf(const Word& word, std::uint64_t pixels) const;
    void compare(const PixelMask& out, const PixelMask& in, const Window& window, int part);
    void noteBlocks(int column, int row, std::uint64_t covered, std::uint64_t freed, int part);
    double overlapAtWhite(std::int64_t coveredWhite, std::int64_t severalWhite) const;
    double overlapChange() const;
    double toneChange();
    void gather(Scale& scale);
    double spreadChange(Scale& scale, const Box& box);

    const SearchSpace& space_;
    const std::optional<PatternSearch::Region> region_;
    const int width_, height_;
    const int block_;          // side of a block, pixels: 1, 2, 4 or 8
    const int blockShift_;     // log2(block_)
    const glm::ivec2 blocks_;  // how many, including those cut by the edges
    LayerCounts counts_;
    std::vector<Word> words_;
    // The pulls of 64 pixels, each + kOffset, in bit planes: the sum over any subset takes a few
    // bit counts.
    static constexpr int kPull = 63, kOffset = 64, kPullPlanes = 7;
    std::vector<std::array<std::uint64_t, kPullPlanes>> pulls_;
    std::vector<std::int64_t> lack_;  // per block: sum I - I', in Goal's units / kLightSteps
    // Per block: the light of one covered pixel, in 1 / kLightSteps; empty: 1 everywhere. A power
    // of two, so that sums stay exact.
    static constexpr int kLightSteps = 32;
    std::vector<std::int32_t> lights_;
    std::array<Scale, kScales> scales_;
    // One axis of the Gaussians' kernel at the nodes around, and how far it reaches either way.
    static constexpr int kReach = 3;
    std::array<double, 2 * kReach + 1> kernel_{};

    std::int64_t sum_ = 0;                              // sum |I - I'|, in Goal's units
    std::int64_t coveredWhite_ = 0, severalWhite_ = 0;  // white pixels with at least one instance, with several
    // Of the current move.
    Change change_;
    std::vector<BlockChange> blockChanges_;
    std::vector<double> row_;  // scratch

    std::vector<std::int64_t> darkness_;  // running sums over the blocks
};

}  // namespace fantascope::pattern
