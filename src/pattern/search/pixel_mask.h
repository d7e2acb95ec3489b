#pragma once

#include "pattern/search/silhouette.h"

#include "core/random.h"

#include <glm/vec2.hpp>

#include <cstdint>
#include <vector>

namespace fantascope::pattern {

// The pixels of one instance as bits: 64 neighbours of a row per word, the words of its bounding
// rectangle column by column.
class PixelMask {
public:
    static constexpr int kBits = 64;

    // Makes it empty.
    void clear() { left_ = right_ = top_ = bottom_ = 0; }
    // Makes it the instance's silhouette.
    void draw(SilhouetteScanner& scanner, const Silhouette& shape, const InstancePose& pose);

    bool empty() const { return left_ == right_; }
    int left() const { return left_; }  // columns of words, left <= column < right
    int right() const { return right_; }
    int top() const { return top_; }  // rows, top <= y < bottom
    int bottom() const { return bottom_; }
    // One column of words; 0 at rows outside the rectangle.
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
    // One of its pixels, uniformly drawn. It must not be empty.
    glm::ivec2 randomPixel(Rng& rng) const;

private:
    struct Run {
        int y, begin, end;
    };
    std::vector<Run> runs_;  // scratch, kept for its memory
    std::vector<std::uint64_t> words_;
    int left_ = 0, right_ = 0, top_ = 0, bottom_ = 0;
};

}  // namespace fantascope::pattern
