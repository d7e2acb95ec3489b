#include "render/gpu/paint/composer.h"

#include "core/check.h"

#include <epoxy/gl.h>
#include <fmt/format.h>
#include <glm/gtc/type_ptr.hpp>

#include <string>
#include <vector>

namespace fantascope::render::gpu {
namespace {

constexpr GLfloat kBlack[] = {0, 0, 0, 1};

// Uniform locations of assets/shaders/compose.frag. An array's is that of its first element; the
// others follow.
constexpr GLint kBlend = 0, kTurn = 4, kWeight = 8, kTint = 9, kCubeFrom = 10, kGamma = 12, kGainShare = 13, kOnMaps = 14;
constexpr GLuint kRoots = 0, kCarriedSum = 4, kCarriedPicture = 5, kCube = 6, kBlendMap = 7, kGainMap = 8;

// The factors of a blend mode: what the picture below loses by the layer's coverage and by its
// light, and what the layer adds.
glm::vec3 factorsOf(show::Blend blend) {
    switch (blend) {
        case show::Blend::Add:
            return {0, 0, 1};
        case show::Blend::Over:
            return {1, 0, 1};
        case show::Blend::Multiply:
            return {1, -1, 0};
        case show::Blend::Screen:
            return {0, 1, 1};
    }
    return {0, 0, 1};
}

void filterBetween(GLuint texture) {
    for (const GLenum direction : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
        glTextureParameteri(texture, direction, GL_CLAMP_TO_EDGE);
    glTextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
}

}  // namespace

Result<Composer> Composer::create(glm::ivec2 size, int samples, ProgramCache& programs, const GreyImage* gain) {
    static_assert(kTogether == 2);
    LayerPicture first = TRY(LayerPicture::create(size, samples)), second = TRY(LayerPicture::create(size, samples));
    Composer composer(size, {std::move(first), std::move(second)}, programs);
    if (gain != nullptr) composer.uploadGain(*gain);
    return composer;
}

Composer::Carried::Carried(glm::ivec2 size) {
    GLenum target = GL_COLOR_ATTACHMENT0;
    for (const Texture* texture : {&sum, &picture}) {
        glTextureStorage2D(texture->name(), 1, GL_RGBA16F, size.x, size.y);
        glNamedFramebufferTexture(framebuffer.name(), target++, texture->name(), 0);
    }
    const GLenum both[] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
    glNamedFramebufferDrawBuffers(framebuffer.name(), 2, both);
}

Result<unsigned> Composer::programFor(std::size_t layers, bool carries, End end) const {
    std::string definitions = fmt::format("#define LAYERS {}\n#define SAMPLES {}\n", layers, samples());
    const auto define = [&](bool when, const char* what) {
        if (when) definitions += fmt::format("#define {}\n", what);
    };
    define(carries, "CARRIED");
    if (end == End::Finish) {
        define(true, "FINISH");
        define(finishing_.tint, "TINT");
        define(finishing_.cube, "CUBE");
        define(finishing_.gain, "GAIN");
        define(finishing_.blend, "BLEND");
        define(finishing_.encode, "ENCODE");
        define(finishing_.dither, "DITHER");
    }
    return programs_->drawing("compose.vert", "compose.frag", definitions);
}

void Composer::moveMaps(const std::optional<Homography>& moved) {
    onMaps_ = glm::mat3(0.0f);
    if (!moved) return;
    const glm::dvec2 size(size_);
    // OpenGL's row 0 is at the bottom, of the picture and of the maps.
    const glm::dmat3 upright(1, 0, 0, 0, -1, 0, 0, size.y, 1), share(1 / size.x, 0, 0, 0, -1 / size.y, 0, 0, 1, 1);
    onMaps_ = share * moved->inverse().matrix() * upright;
}

void Composer::uploadCube() {
    cube_.reset();
    if (!uploadedCube_) return;
    const ColourCube& cube = *uploadedCube_;
    const GLuint texture = cube_.emplace().name();
    glTextureStorage3D(texture, 1, GL_RGB16F, cube.side, cube.side, cube.side);
    glTextureSubImage3D(texture, 0, 0, 0, 0, cube.side, cube.side, cube.side, GL_RGB, GL_FLOAT, cube.colours.data());
    filterBetween(texture);
    const float inner = static_cast<float>(cube.side - 1) / static_cast<float>(cube.side);
    cubeFrom_[0] = inner / (cube.high - cube.low);
    cubeFrom_[1] = 0.5f / static_cast<float>(cube.side) - cube.low * cubeFrom_[0];
}

void Composer::uploadBlendMap() {
    blendMap_.reset();
    if (!uploadedBlend_) return;
    const BlendMap& blend = *uploadedBlend_;
    FANTASCOPE_CHECK(glm::ivec2(blend.width(), blend.height()) == size_, "the blend map has the projector's size");
    const GLuint texture = blendMap_.emplace().name();
    glTextureStorage2D(texture, 1, GL_RG16F, size_.x, size_.y);
    // OpenGL's row 0 is at the bottom.
    for (int y = 0; y < size_.y; ++y)
        glTextureSubImage2D(texture, 0, 0, size_.y - 1 - y, size_.x, 1, GL_RG, GL_FLOAT, blend.row(y).data());
    filterBetween(texture);
}

void Composer::uploadGain(const GreyImage& gain) {
    FANTASCOPE_CHECK(glm::ivec2(gain.width(), gain.height()) == size_, "the light correction has the projector's size");
    const GLuint texture = gainMap_.emplace().name();
    glTextureStorage2D(texture, 1, GL_R16F, size_.x, size_.y);
    // OpenGL's row 0 is at the bottom.
    for (int y = 0; y < size_.y; ++y)
        glTextureSubImage2D(texture, 0, 0, size_.y - 1 - y, size_.x, 1, GL_RED, GL_FLOAT, gain.row(y).data());
    filterBetween(texture);
}

Result<void> Composer::follow(const ProjectorLight& light, const std::shared_ptr<const BlendMap>& blend) {
    tint_ = light.white * light.brightness;
    gamma_ = static_cast<float>(light.gamma.value_or(0));
    finishing_ = {tint_ != glm::vec3(1),
                  light.cube != nullptr,
                  gainMap_.has_value(),
                  blend != nullptr,
                  light.dither || light.gamma.has_value(),
                  light.dither};
    // Uploading is expensive, and a technician who moves a corner changes neither.
    if (std::exchange(uploadedCube_, light.cube) != light.cube) uploadCube();
    if (std::exchange(uploadedBlend_, blend) != blend) uploadBlendMap();
    for (std::size_t layers = 0; layers <= kTogether; ++layers)
        for (const bool carries : {false, true})
            for (const End end : {End::Carry, End::Finish}) {
                // Only a full pass is carried on, and a pass without layers is that of an empty
                // frame.
                if (end == End::Carry ? layers < kTogether : layers == 0 && carries) continue;
                passes_[layers][carries][static_cast<std::size_t>(end)] = TRY(programFor(layers, carries, end));
            }
    return {};
}

void Composer::begin() {
    count_ = 0;
    carries_ = false;
    weight_ = 0;
    fresh_ = true;
}

LayerPicture& Composer::nextPicture() {
    if (count_ == kTogether) pass(End::Carry, 0);
    return pictures_[count_];
}

void Composer::lay(float opacity, show::Blend blend) {
    layers_[count_++] = {opacity * factorsOf(blend), fresh_ ? glm::vec2(weight_, 0) : glm::vec2(0, 1)};
    fresh_ = false;
}

void Composer::endPicture(float weight) {
    if (std::exchange(fresh_, true)) return;  // a picture without layers does not count
    weight_ = weight;
}

void Composer::finish(unsigned framebuffer) {
    endPicture(1);
    if (count_ == 0 && !carries_ && !finishing_.blend)
        glClearNamedFramebufferfv(framebuffer, GL_COLOR, 0, kBlack);
    else
        pass(End::Finish, framebuffer);
}

void Composer::pass(End end, unsigned framebuffer) {
    const std::size_t next = 1 - newest_;
    if (end == End::Carry) {
        if (!carried_[next]) carried_[next] = std::make_unique<Carried>(size_);
        framebuffer = carried_[next]->framebuffer.name();
    }
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer);
    glViewport(0, 0, size_.x, size_.y);
    (finishing_.encode ? glDisable : glEnable)(GL_FRAMEBUFFER_SRGB);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glUseProgram(passes_[count_][carries_][static_cast<std::size_t>(end)]);
    for (std::size_t i = 0; i < count_; ++i) {
        glUniform3fv(kBlend + static_cast<GLint>(i), 1, glm::value_ptr(layers_[i].blend));
        glUniform2fv(kTurn + static_cast<GLint>(i), 1, glm::value_ptr(layers_[i].turn));
        glBindTextureUnit(kRoots + static_cast<GLuint>(i), pictures_[i].texture());
    }
    if (carries_) {
        glBindTextureUnit(kCarriedSum, carried_[newest_]->sum.name());
        glBindTextureUnit(kCarriedPicture, carried_[newest_]->picture.name());
    }
    if (end == End::Finish) {
        glUniform1f(kWeight, weight_);
        if (finishing_.tint) glUniform3fv(kTint, 1, glm::value_ptr(tint_));
        if (finishing_.cube) {
            glUniform3fv(kCubeFrom, 2, glm::value_ptr(cubeFrom_[0]));
            glBindTextureUnit(kCube, cube_->name());
        }
        if (finishing_.gain) {
            glUniform1f(kGainShare, gainShare_);
            glBindTextureUnit(kGainMap, gainMap_->name());
        }
        if (finishing_.gain || finishing_.blend) glUniformMatrix3fv(kOnMaps, 1, GL_FALSE, glm::value_ptr(onMaps_));
        if (finishing_.blend) glBindTextureUnit(kBlendMap, blendMap_->name());
        if (finishing_.encode) glUniform1f(kGamma, gamma_);
    }
    glBindVertexArray(noVertices_.name());
    glDrawArrays(GL_TRIANGLES, 0, 3);
    newest_ = next;
    carries_ = true;
    count_ = 0;
}

void Composer::warmUp(unsigned framebuffer) {
    for (std::size_t layers = 0; layers <= 3 * kTogether; ++layers) {
        begin();
        for (std::size_t i = 0; i < layers; ++i) {
            nextPicture().begin();
            lay(1, show::Blend::Add);
        }
        endPicture(1);
        finish(framebuffer);
    }
}

}  // namespace fantascope::render::gpu
