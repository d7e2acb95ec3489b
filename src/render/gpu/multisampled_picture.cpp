#include "render/gpu/multisampled_picture.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <algorithm>

namespace fantascope::render::gpu {

Result<MultisampledPicture> MultisampledPicture::create(glm::ivec2 size, int samples) {
    GLint mostSamples = 0, largest = 0;
    glGetIntegerv(GL_MAX_SAMPLES, &mostSamples);
    glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &largest);
    if (samples < 1 || samples > mostSamples) return Error(fmt::format("{} samples a pixel: this OpenGL has 1 .. {}", samples, mostSamples));
    if (std::min(size.x, size.y) < 1 || std::max(size.x, size.y) > largest)
        return Error(fmt::format("{} x {} pixels: this OpenGL draws 1 .. {} in each dimension", size.x, size.y, largest));

    MultisampledPicture picture(size);
    glNamedRenderbufferStorageMultisample(picture.colour_.name(), samples, GL_SRGB8_ALPHA8, size.x, size.y);
    glNamedRenderbufferStorageMultisample(picture.depth_.name(), samples, GL_DEPTH_COMPONENT24, size.x, size.y);
    const GLuint framebuffer = picture.framebuffer_.name();
    glNamedFramebufferRenderbuffer(framebuffer, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, picture.colour_.name());
    glNamedFramebufferRenderbuffer(framebuffer, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, picture.depth_.name());
    if (glCheckNamedFramebufferStatus(framebuffer, GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        return Error(fmt::format("{} x {} pixels with {} samples: this OpenGL cannot draw them", size.x, size.y, samples));
    return picture;
}

void MultisampledPicture::begin() {
    glEnable(GL_FRAMEBUFFER_SRGB);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer_.name());
    glViewport(0, 0, size_.x, size_.y);
    const GLfloat black[] = {0, 0, 0, 1};
    glClearNamedFramebufferfv(framebuffer_.name(), GL_COLOR, 0, black);
}

void MultisampledPicture::resolveInto(unsigned framebuffer) {
    glBlitNamedFramebuffer(framebuffer_.name(), framebuffer, 0, 0, size_.x, size_.y, 0, 0, size_.x, size_.y, GL_COLOR_BUFFER_BIT,
                           GL_NEAREST);
    const GLenum done[] = {GL_COLOR_ATTACHMENT0, GL_DEPTH_ATTACHMENT};
    glInvalidateNamedFramebufferData(framebuffer_.name(), 2, done);
}

}  // namespace fantascope::render::gpu
