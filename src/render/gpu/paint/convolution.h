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
// shaders. The cost depends on the picture's size and not on the filter's content. Nothing wraps
// around; beyond the painted picture the coverage is 0.
// Source: Ji et al. 2015, section 5.1. Thread: the context's.
class Convolution {
public:
    // `size`: pixels of the blurred picture. `filter`: what a single covered pixel becomes, with
    // the same orientation as the painted picture; both sides odd. `block`: painted pixels per
    // blurred pixel, in each dimension. `samples`: per pixel of the painted picture. `programs`
    // outlives it. Error: a shader does not compile, or more pixels than OpenGL allows here.
    static Result<Convolution> create(glm::ivec2 size, const GreyImage& filter, int block, int samples, ProgramCache& programs);

    // By how many blurred pixels run()'s picture extends beyond the blurred one, on every side.
    glm::ivec2 margin() const { return margin_; }
    // Blurs the coverage (0 .. 1) of `painted`, which is (size + 2 margin) * block pixels large.
    // Then texture() holds fromCoverage.x + fromCoverage.y * coverage, never negative.
    void run(const LayerPicture& painted, glm::vec2 fromCoverage);
    // One channel. Texel (0, 0) begins at the painted picture's texel margin() * block.
    unsigned texture() const { return blurred_.name(); }

private:
    struct Pass {
        unsigned program;
        glm::ivec2 along;  // (1, 0): along rows
        int span;
        glm::ivec2 count;  // butterflies
    };
    Convolution(glm::ivec2 size, glm::ivec2 margin) : margin_(margin), quarter_((size + 1) / 2), whole_(size + 2 * margin) {}

    glm::ivec2 margin_, quarter_;  // pixels; the quarters of an odd picture extend beyond it by one
    glm::ivec2 whole_;             // pixels, with the margin
    unsigned cover_ = 0;           // the program that averages the painted picture
    std::vector<Pass> passes_;
    Texture coverage_, field_, spectrum_, blurred_;
};

}  // namespace fantascope::render::gpu
