#pragma once

#include "core/image.h"

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include <array>
#include <memory>
#include <vector>

namespace fantascope::site {

// A projector's frame as the light that leaves its lens: linear, 1 is a full white pixel, w unused; averaged over cells of 1, 2,
// 4 ... pixels, so that a camera pixel that covers many of the projector's sees all of them. Thread-bound.
class ProjectedLight {
public:
    // light = blackLevel + (1 - blackLevel) stored^gamma. blackLevel 0..1, gamma > 0.
    ProjectedLight(glm::ivec2 size, double gamma, double blackLevel);

    // Takes a new frame, stretched to the projector's own pixels if its size differs; null is no light at all. Does nothing if it
    // is the one that it has already.
    void show(std::shared_ptr<const RgbaImage> frame);
    bool dark() const { return frame_ == nullptr; }

    // The finest cells that are at least about `footprint` pixels wide, as an index for at().
    static int levelFor(double footprint);
    // Bilinear between cell centres; `pixel` in [0, width] x [0, height]. Not while dark().
    glm::vec4 at(int level, glm::vec2 pixel) const;
    // Of the whole frame. Not while dark().
    glm::vec4 mean() const;

private:
    using LightImage = Image<glm::vec4>;
    glm::ivec2 size_;
    std::array<float, 256> lightOf_{};
    std::shared_ptr<const RgbaImage> frame_;
    std::vector<LightImage> levels_;  // each has half the width and height of the one before
};

}  // namespace fantascope::site
