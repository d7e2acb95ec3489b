#pragma once

#include "pattern/search/silhouette.h"

#include "media/image.h"

#include <glm/vec2.hpp>

#include <bit>
#include <cstdint>
#include <utility>
#include <vector>

namespace fantascope::pattern {

// Pixels begin.x <= x < end.x, begin.y <= y < end.y.
struct PixelRectangle {
    glm::ivec2 begin{0}, end{0};

    std::int64_t area() const { return std::int64_t{end.x - begin.x} * (end.y - begin.y); }
};

// The pixels that a set of silhouettes covers, one bit each: a shape pattern drawn white on black
// (Ji et al. 2015, section 4.1).
class Coverage {
public:
    // Covers nothing; width, height > 0.
    Coverage(int width, int height);

    int width() const { return width_; }
    int height() const { return height_; }
    void clear();
    // Adds the silhouette of one instance; see SilhouetteScanner.
    void add(const Silhouette& shape, const InstancePose& pose);

    bool at(int x, int y) const { return (word(x, y) >> (x % kBits) & 1) != 0; }
    // How many pixels of the rectangle are covered. It must lie in the picture.
    std::int64_t count(const PixelRectangle& cell) const;
    // Calls use(y, begin, end) for each maximal run begin <= x < end of covered pixels, from the
    // top left on.
    template <class Use>
    void forEachRun(Use use) const {
        const std::uint64_t* next = words_.data();
        for (int y = 0; y < height_; ++y) {
            int begin = -1;            // of the current run
            std::uint64_t before = 0;  // the pixel left of this word
            for (int first = 0; first < width_; first += kBits) {
                const std::uint64_t bits = *next++;
                // Set where a pixel differs from the one to its left: a run begins or ends there.
                for (std::uint64_t changes = bits ^ (bits << 1 | before); changes != 0; changes &= changes - 1) {
                    const int x = first + std::countr_zero(changes);
                    if (begin >= 0)
                        use(y, std::exchange(begin, -1), x);
                    else
                        begin = x;
                }
                before = bits >> (kBits - 1);
            }
            if (begin >= 0) use(y, begin, width_);
        }
    }

    GreyImage picture() const;  // white on black

private:
    static constexpr int kBits = 64;
    std::uint64_t word(int x, int y) const {
        return words_[static_cast<std::size_t>(y) * stride_ + static_cast<std::size_t>(x / kBits)];
    }
    void addSpan(int y, int begin, int end);

    int width_, height_;
    std::size_t stride_;                // words per row
    std::vector<std::uint64_t> words_;  // pixel x is bit x % 64 of its word; bits beyond the width are 0
    SilhouetteScanner scanner_;
};

}  // namespace fantascope::pattern
