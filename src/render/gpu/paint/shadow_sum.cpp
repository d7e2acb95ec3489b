#include "render/gpu/paint/shadow_sum.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

namespace fantascope::render::gpu {
namespace {

constexpr int kMaxMarks = 255;  // a stencil has 8 bits; 0 marks no light

}  // namespace

Result<ShadowSum> ShadowSum::create(glm::ivec2 size, int samples) {
    ShadowSum made(size);
    // With half floats, rounding would leave some grey where a hundred points of light are all in
    // shadow.
    glTextureStorage2DMultisample(made.sum_.name(), samples, GL_RGBA32F, size.x, size.y, GL_TRUE);
    glGetTextureLevelParameteriv(made.sum_.name(), 0, GL_TEXTURE_SAMPLES, &made.samples_);
    glNamedRenderbufferStorageMultisample(made.depth_.name(), samples, GL_DEPTH24_STENCIL8, size.x, size.y);
    const GLuint framebuffer = made.framebuffer_.name();
    glNamedFramebufferTexture(framebuffer, GL_COLOR_ATTACHMENT0, made.sum_.name(), 0);
    glNamedFramebufferRenderbuffer(framebuffer, GL_DEPTH_STENCIL_ATTACHMENT, GL_RENDERBUFFER, made.depth_.name());
    if (glCheckNamedFramebufferStatus(framebuffer, GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        return Error(fmt::format("{} x {} pixels with {} samples per pixel: OpenGL cannot sum up shadows in them here", size.x,
                                 size.y, samples));
    return made;
}

void ShadowSum::begin() {
    constexpr GLfloat kNothing[] = {0, 0, 0, 0};
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer_.name());
    glViewport(0, 0, size_.x, size_.y);
    glClearNamedFramebufferfv(framebuffer_.name(), GL_COLOR, 0, kNothing);
    glClearNamedFramebufferfi(framebuffer_.name(), GL_DEPTH_STENCIL, 0, 1, 0);
    mark_ = 0;
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE);
    glEnable(GL_STENCIL_TEST);
    glStencilOp(GL_KEEP, GL_KEEP, GL_REPLACE);
}

void ShadowSum::add(ShadowCaster& caster, const ShadowCaster::Light& light, std::span<const glm::vec3> taken, bool alike) {
    constexpr GLint kNobodys = 0;
    constexpr GLfloat kFarthest = 1;
    // Marks the samples in this light's shadow, so that a second mesh does not take away the same
    // light.
    if (++mark_ > kMaxMarks) {
        glClearNamedFramebufferiv(framebuffer_.name(), GL_STENCIL, 0, &kNobodys);
        mark_ = 1;
    }
    (alike ? glDisable : glEnable)(GL_DEPTH_TEST);
    if (!alike) {
        // Finds the nearest piece first, then draws its colour.
        glClearNamedFramebufferfv(framebuffer_.name(), GL_DEPTH, 0, &kFarthest);
        glDepthFunc(GL_LESS);
        glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
        glDisable(GL_STENCIL_TEST);
        caster.draw(light, taken);
        glEnable(GL_STENCIL_TEST);
        glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
        glDepthFunc(GL_EQUAL);
    }
    glStencilFunc(GL_NOTEQUAL, mark_, 0xff);
    caster.draw(light, taken);
}

void ShadowSum::end() {
    glDisable(GL_BLEND);
    glDisable(GL_STENCIL_TEST);
}

}  // namespace fantascope::render::gpu
