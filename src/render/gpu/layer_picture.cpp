#include "render/gpu/layer_picture.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <algorithm>

namespace fantascope::render::gpu {
namespace {

constexpr GLfloat kUncovered[] = {0, 0, 0, 0};

}  // namespace

Result<LayerPicture> LayerPicture::create(glm::ivec2 size, int samples) {
    GLint maxSamples = 0, largest = 0;
    glGetIntegerv(GL_MAX_COLOR_TEXTURE_SAMPLES, &maxSamples);
    glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &largest);
    if (samples < 1 || samples > maxSamples)
        return Error(fmt::format("{} samples per pixel: OpenGL has 1 .. {} here", samples, maxSamples));
    if (std::min(size.x, size.y) < 1 || std::max(size.x, size.y) > largest)
        return Error(fmt::format("{} x {} pixels: OpenGL draws 1 .. {} per dimension here", size.x, size.y, largest));

    LayerPicture picture(size);
    const GLuint framebuffer = picture.framebuffer_.name();
    glTextureStorage2DMultisample(picture.roots_.name(), samples, GL_RGBA8, size.x, size.y, GL_TRUE);
    glGetTextureLevelParameteriv(picture.roots_.name(), 0, GL_TEXTURE_SAMPLES, &picture.samples_);
    glNamedRenderbufferStorageMultisample(picture.depth_.name(), samples, GL_DEPTH_COMPONENT32F, size.x, size.y);
    glNamedFramebufferTexture(framebuffer, GL_COLOR_ATTACHMENT0, picture.roots_.name(), 0);
    glNamedFramebufferRenderbuffer(framebuffer, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, picture.depth_.name());
    if (glCheckNamedFramebufferStatus(framebuffer, GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        return Error(
            fmt::format("{} x {} pixels with {} samples per pixel: OpenGL cannot draw them here", size.x, size.y, samples));
    return picture;
}

void LayerPicture::begin() {
    const GLfloat farthest = 1;
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer_.name());
    glViewport(0, 0, size_.x, size_.y);
    glClearNamedFramebufferfv(framebuffer_.name(), GL_COLOR, 0, kUncovered);
    glClearNamedFramebufferfv(framebuffer_.name(), GL_DEPTH, 0, &farthest);
}

}  // namespace fantascope::render::gpu
