#pragma once

#include "render/gpu/handles.h"
#include "render/gpu/paint/shadow_caster.h"

#include "core/result.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <span>

namespace fantascope::render::gpu {

// Sums up the light of many points that shadows take away, in a picture of an output with several
// samples per pixel. For each frame call begin(), add() for each point of light, end(). Thread: the
// context's.
class ShadowSum {
public:
    // Error: more pixels or samples than OpenGL allows here.
    static Result<ShadowSum> create(glm::ivec2 size, int samples);

    void begin();
    // `taken`: linear light that each piece takes away in its shadow. Where shadows overlap, the
    // piece nearest to the light counts. `alike`: all pieces take the same, so the nearest one need
    // not be found.
    void add(ShadowCaster& caster, const ShadowCaster::Light& light, std::span<const glm::vec3> taken, bool alike);
    void end();

    int samples() const { return samples_; }
    unsigned texture() const { return sum_.name(); }  // multisampled

private:
    explicit ShadowSum(glm::ivec2 size) : size_(size) {}

    glm::ivec2 size_;
    int samples_ = 0;
    MultisampleTexture sum_;
    Renderbuffer depth_;
    Framebuffer framebuffer_;
    int mark_ = 0;  // stencil value of the samples in the current light's shadow
};

}  // namespace fantascope::render::gpu
