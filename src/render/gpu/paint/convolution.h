#pragma once

#include "render/gpu/handles.h"
#include "render/gpu/layer_picture.h"
#include "render/gpu/program_cache.h"

#include "core/result.h"
#include "media/image.h"

#include <glm/vec2.hpp>

#include <vector>

namespace fantascope::render::gpu {

// Convolves the coverage of a painted picture with a filter, by fast Fourier transform in compute
// shaders: what it costs hangs on the picture's size and not on what the filter shows. Nothing
// wraps around; beyond what was painted nothing covers.
// Source: Ji et al. 2015, section 5.1. Thread: the context's.
class Convolution {
public:
    // `size`: pixels of the blurred picture. `filter`: the picture that a single covered pixel
    // becomes, upright as the painted one; odd sides. `block`: painted pixels to a blurred one, in
    // each dimension. `samples`: of the painted picture. `programs` outlives it. Error: a shader
    // does not compile; more pixels than this OpenGL has.
    static Result<Convolution> create(glm::ivec2 size, const GreyImage& filter, int block, int samples, ProgramCache& programs);

    // Blurred pixels by which the picture that run() is given reaches over the blurred one, on
    // every side.
    glm::ivec2 margin() const { return margin_; }
    // Blurs the coverage (0 .. 1) of `painted`, (size + 2 margin) block pixels: texture() is then
    // fromCoverage.x + fromCoverage.y * coverage, never negative.
    void run(const LayerPicture& painted, glm::vec2 fromCoverage);
    // One channel; texel (0, 0) lies in the painted picture's texel margin() * block.
    unsigned texture() const { return blurred_.name(); }

private:
    struct Pass {
        unsigned program;
        glm::ivec2 along;  // (1, 0): rows
        int span;
        glm::ivec2 count;  // butterflies
    };
    Convolution(glm::ivec2 size, glm::ivec2 margin) : margin_(margin), quarter_((size + 1) / 2), whole_(size + 2 * margin) {}

    glm::ivec2 margin_, quarter_;  // pixels; the quarters of an odd picture reach over it by one
    glm::ivec2 whole_;             // pixels with the margin
    unsigned cover_ = 0;           // the program that averages the painted picture
    std::vector<Pass> passes_;
    Texture coverage_, field_, spectrum_, blurred_;
};

}  // namespace fantascope::render::gpu
