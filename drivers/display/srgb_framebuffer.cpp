#include "drivers/display/srgb_framebuffer.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

namespace fantascope::drivers {

Result<unsigned> makeSrgbFramebuffer(glm::ivec2 size) {
    GLint largest = 0;
    glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &largest);
    if (size.x > largest || size.y > largest)
        return Error(fmt::format("{} x {} pixels: this OpenGL draws at most {} in a dimension", size.x, size.y, largest));
    GLuint colour = 0, framebuffer = 0;
    glCreateRenderbuffers(1, &colour);
    glNamedRenderbufferStorage(colour, GL_SRGB8_ALPHA8, size.x, size.y);
    glCreateFramebuffers(1, &framebuffer);
    glNamedFramebufferRenderbuffer(framebuffer, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, colour);
    if (glCheckNamedFramebufferStatus(framebuffer, GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        return Error(fmt::format("{} x {} pixels: this OpenGL cannot draw sRGB pictures; update its driver", size.x, size.y));
    const GLfloat black[] = {0, 0, 0, 1};
    glClearNamedFramebufferfv(framebuffer, GL_COLOR, 0, black);
    return framebuffer;
}

}  // namespace fantascope::drivers
