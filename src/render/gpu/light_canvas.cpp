#include "render/gpu/light_canvas.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <algorithm>

namespace fantascope::render::gpu {

Result<LightCanvas> LightCanvas::create(glm::ivec2 size) {
    GLint largest = 0;
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
    if (std::max(size.x, size.y) > largest)
        return Error(fmt::format("{} x {} pixels: OpenGL draws at most {} per dimension here", size.x, size.y, largest));
    LightCanvas canvas(size);
    const GLuint light = canvas.light_.name();
    glTextureStorage2D(light, 1, GL_R16F, size.x, size.y);
    glTextureParameteri(light, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTextureParameteri(light, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTextureParameteri(light, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    glNamedFramebufferTexture(canvas.framebuffer_.name(), GL_COLOR_ATTACHMENT0, light, 0);
    return canvas;
}

void LightCanvas::begin() {
    constexpr GLfloat kDark[] = {0, 0, 0, 0};
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer_.name());
    glViewport(0, 0, size_.x, size_.y);
    glClearNamedFramebufferfv(framebuffer_.name(), GL_COLOR, 0, kDark);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE);
}

void LightCanvas::end() { glDisable(GL_BLEND); }

}  // namespace fantascope::render::gpu
