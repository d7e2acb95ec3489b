#pragma once

#include "media/image.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <array>
#include <memory>
#include <vector>

namespace fantascope::site {

// A projector's frame as the light that leaves its lens: linear, 1 is a full white pixel, w unused.
// It is averaged over cells of 1, 2, 4 ... pixels, so that a camera pixel that covers many
// projector pixels sees all of them. Thread-bound.
class ProjectedLight {
    using LightImage = Image<glm::vec4>;

public:
    // The smallest frame: interpolation needs two pixels each way.
    static constexpr int kMinSide = 2;
    // light = white (blackLevel + (1 - blackLevel) stored^gamma). blackLevel 0..1, gamma > 0,
    // `white`: strengths of the primaries, size >= kMinSide each way.
    ProjectedLight(glm::ivec2 size, double gamma, double blackLevel, glm::vec3 white = glm::vec3(1));

    // Sets a new frame, stretched to the projector's own pixels if its size differs; null is no
    // light at all. `blur`: sigma of a Gaussian, projector pixels. `level`: the share of its light
    // that the projector gives. Setting the same again does nothing.
    void show(std::shared_ptr<const RgbaImage> frame, double blur = 0, double level = 1);
    bool dark() const { return frame_ == nullptr; }

    // A place in the frame, computed once and read from every frame.
    struct Place {
        std::uint32_t level = 0;   // cells of 2^level pixels
        std::uint32_t corner = 0;  // the cell whose centre is next above and left
        glm::vec2 share{0};        // of the way from there to the next centres right and below
    };
    // For frames of `size`, around `pixel` in [0, width] x [0, height], with cells about
    // `footprint` pixels wide.
    static Place placeOf(glm::ivec2 size, glm::vec2 pixel, double footprint);
    // Bilinear between cell centres. Not while dark().
    glm::vec4 at(const Place& place) const {
        const LightImage& cells = levels_[place.level];
        const glm::vec4* top = cells.pixels().data() + place.corner;
        const glm::vec4* bottom = top + cells.width();
        const glm::vec4 above = top[0] + (top[1] - top[0]) * place.share.x;
        const glm::vec4 below = bottom[0] + (bottom[1] - bottom[0]) * place.share.x;
        return above + (below - above) * place.share.y;
    }
    // The mean of the whole frame. Not while dark().
    glm::vec4 mean() const;

private:
    glm::ivec2 size_;
    glm::vec4 white_;
    std::array<float, 256> lightOf_{};
    std::shared_ptr<const RgbaImage> frame_;
    double blur_ = 0, level_ = 1;
    std::vector<LightImage> levels_;  // each half as wide and high as the one before
};

}  // namespace fantascope::site
