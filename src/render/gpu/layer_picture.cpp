#include "render/gpu/layer_picture.h"

#include "render/gpu/shader_program.h"

#include "core/check.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <algorithm>

namespace fantascope::render::gpu {
namespace {

constexpr GLfloat kBlack[] = {0, 0, 0, 1};
constexpr GLfloat kUncovered[] = {0, 0, 0, 0};

// Of assets/shaders/resolve.frag: the first layer's; the others' follow.
constexpr GLint kOpacity = 0;
constexpr GLuint kRoots = 0;

}  // namespace

Result<LayerPicture> LayerPicture::create(glm::ivec2 size, int samples) {
    GLint mostSamples = 0, largest = 0;
    glGetIntegerv(GL_MAX_COLOR_TEXTURE_SAMPLES, &mostSamples);
    glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &largest);
    if (samples < 1 || samples > mostSamples)
        return Error(fmt::format("{} samples a pixel: this OpenGL has 1 .. {}", samples, mostSamples));
    if (std::min(size.x, size.y) < 1 || std::max(size.x, size.y) > largest)
        return Error(fmt::format("{} x {} pixels: this OpenGL draws 1 .. {} in each dimension", size.x, size.y, largest));

    LayerPicture picture(size);
    const GLuint framebuffer = picture.framebuffer_.name();
    glTextureStorage2DMultisample(picture.roots_.name(), samples, GL_RGBA8, size.x, size.y, GL_TRUE);
    glGetTextureLevelParameteriv(picture.roots_.name(), 0, GL_TEXTURE_SAMPLES, &picture.samples_);
    glNamedRenderbufferStorageMultisample(picture.depth_.name(), samples, GL_DEPTH_COMPONENT32F, size.x, size.y);
    glNamedFramebufferTexture(framebuffer, GL_COLOR_ATTACHMENT0, picture.roots_.name(), 0);
    glNamedFramebufferRenderbuffer(framebuffer, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, picture.depth_.name());
    if (glCheckNamedFramebufferStatus(framebuffer, GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        return Error(fmt::format("{} x {} pixels with {} samples: this OpenGL cannot draw them", size.x, size.y, samples));
    return picture;
}

void LayerPicture::begin() {
    const GLfloat farthest = 1;
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer_.name());
    glViewport(0, 0, size_.x, size_.y);
    glClearNamedFramebufferfv(framebuffer_.name(), GL_COLOR, 0, kUncovered);
    glClearNamedFramebufferfv(framebuffer_.name(), GL_DEPTH, 0, &farthest);
}

Result<LightSum> LightSum::create(int samples, const std::filesystem::path& shaders) {
    LightSum sum;
    for (std::size_t i = 0; i < kTogether; ++i)
        sum.programs_[i] = TRY(loadProgram(shaders / "resolve.vert", shaders / "resolve.frag",
                                           fmt::format("#define LAYERS {}\n#define SAMPLES {}\n", i + 1, samples)));
    return sum;
}

void LightSum::shine(unsigned framebuffer, std::span<const Layer> layers, Light light) {
    FANTASCOPE_CHECK(!layers.empty() && layers.size() <= kTogether, "one pass takes one layer to kTogether");
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer);
    glEnable(GL_FRAMEBUFFER_SRGB);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    if (light == Light::Added) {
        glEnable(GL_BLEND);
        glBlendFunc(GL_ONE, GL_ONE);
    }
    glUseProgram(programs_[layers.size() - 1].name());
    for (std::size_t i = 0; i < layers.size(); ++i) {
        glUniform1f(kOpacity + static_cast<GLint>(i), layers[i].opacity);
        glBindTextureUnit(kRoots + static_cast<GLuint>(i), layers[i].picture->texture());
    }
    glBindVertexArray(noVertices_.name());
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glDisable(GL_BLEND);
}

void darken(unsigned framebuffer) { glClearNamedFramebufferfv(framebuffer, GL_COLOR, 0, kBlack); }

}  // namespace fantascope::render::gpu
