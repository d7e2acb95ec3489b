#pragma once

#include "render/gpu/handles.h"
#include "render/gpu/paint/shadow_caster.h"

#include "core/result.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <span>

namespace fantascope::render::gpu {

// What shadows take away of the light of many points, summed up in a picture of an output, several
// samples a pixel. A frame: begin(), add() each point of light, end(). Thread: the context's.
class ShadowSum {
public:
    // Error: more pixels or samples than this OpenGL has.
    static Result<ShadowSum> create(glm::ivec2 size, int samples);

    void begin();
    // What each piece takes away in its shadow, linear light. Where shadows of pieces meet, that of
    // the piece nearest to the light counts; `alike`: all pieces take the same, so that it need not
    // be found out which that is.
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
    int mark_ = 0;  // of the samples that the shadow of the light of now has reached
};

}  // namespace fantascope::render::gpu
