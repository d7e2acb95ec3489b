#include "render/gpu/shadow_caster.h"

#include "core/check.h"

#include <epoxy/gl.h>
#include <fmt/format.h>
#include <glm/gtc/type_ptr.hpp>
#include <glm/matrix.hpp>

#include <cstddef>

namespace fantascope::render::gpu {
namespace {

// Of assets/shaders/skin.comp.
constexpr GLuint kAtRest = 0, kMoved = 1;
constexpr GLint kRange = 0, kMotions = 1;
constexpr unsigned kTogether = 64;  // vertices of a work group

// Of assets/shaders/shadow.vert and shadow.frag.
constexpr GLuint kPosition = 0;
constexpr GLint kScreenFromStage = 0, kClipFromScreen = 1, kTaken = 2;

constexpr int kMostMarks = 255;  // a stencil of 8 bits, 0 being nobody's

static_assert(sizeof(ShadowCaster::Vertex) == 8 * sizeof(float), "the shader reads two vectors a vertex");

}  // namespace

Result<ShadowCaster> ShadowCaster::create(std::span<const Piece> pieces, glm::ivec2 size, int samples, const Bend& bend,
                                          ProgramCache& programs) {
    ShadowCaster caster(size, bend);
    caster.skin_ = TRY(programs.compute("skin.comp", fmt::format("#define JOINTS {}\n", kMostJoints)));
    caster.straight_ = TRY(programs.drawing("shadow.vert", "shadow.frag"));
    caster.bent_ = TRY(programs.drawing("shadow.vert", "shadow.frag", TRY(Bend::definitions(programs.folder()))));

    std::vector<Vertex> vertices;
    std::vector<glm::uvec3> triangles;
    for (const Piece& piece : pieces) {
        const auto first = static_cast<unsigned>(vertices.size());
        caster.parts_.push_back({first, static_cast<unsigned>(piece.vertices.size()), static_cast<unsigned>(3 * triangles.size()),
                                 static_cast<unsigned>(3 * piece.triangles.size()), piece.closed});
        vertices.insert(vertices.end(), piece.vertices.begin(), piece.vertices.end());
        for (const glm::uvec3& triangle : piece.triangles) triangles.push_back(triangle + first);
    }
    const auto store = [](const Buffer& buffer, std::size_t bytes, const void* data) {
        glNamedBufferStorage(buffer.name(), static_cast<GLsizeiptr>(bytes), data, 0);
    };
    store(caster.atRest_, std::span(vertices).size_bytes(), vertices.data());
    store(caster.moved_, vertices.size() * sizeof(glm::vec4), nullptr);
    store(caster.indices_, std::span(triangles).size_bytes(), triangles.data());
    const GLuint array = caster.vertexArray_.name();
    glVertexArrayElementBuffer(array, caster.indices_.name());
    glVertexArrayVertexBuffer(array, 0, caster.moved_.name(), 0, sizeof(glm::vec4));
    glEnableVertexArrayAttrib(array, kPosition);
    glVertexArrayAttribFormat(array, kPosition, 4, GL_FLOAT, GL_FALSE, 0);
    glVertexArrayAttribBinding(array, kPosition, 0);

    glTextureStorage2DMultisample(caster.taken_.name(), samples, GL_RGBA32F, size.x, size.y, GL_TRUE);
    glGetTextureLevelParameteriv(caster.taken_.name(), 0, GL_TEXTURE_SAMPLES, &caster.samples_);
    glNamedRenderbufferStorageMultisample(caster.depth_.name(), samples, GL_DEPTH24_STENCIL8, size.x, size.y);
    const GLuint framebuffer = caster.framebuffer_.name();
    glNamedFramebufferTexture(framebuffer, GL_COLOR_ATTACHMENT0, caster.taken_.name(), 0);
    glNamedFramebufferRenderbuffer(framebuffer, GL_DEPTH_STENCIL_ATTACHMENT, GL_RENDERBUFFER, caster.depth_.name());
    if (glCheckNamedFramebufferStatus(framebuffer, GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        return Error(
            fmt::format("{} x {} pixels with {} samples: this OpenGL cannot draw shadows in them", size.x, size.y, samples));
    return caster;
}

void ShadowCaster::move(std::size_t piece, std::span<const glm::vec4> motions) {
    const Part& part = parts_[piece];
    glUseProgram(skin_);
    glUniform2ui(kRange, part.firstVertex, part.vertexCount);
    glUniform4fv(kMotions, static_cast<GLsizei>(motions.size()), glm::value_ptr(motions[0]));
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, kAtRest, atRest_.name());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, kMoved, moved_.name());
    glDispatchCompute((part.vertexCount + kTogether - 1) / kTogether, 1, 1);
}

void ShadowCaster::begin() {
    constexpr GLfloat kNothing[] = {0, 0, 0, 0};
    glMemoryBarrier(GL_VERTEX_ATTRIB_ARRAY_BARRIER_BIT);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer_.name());
    glViewport(0, 0, size_.x, size_.y);
    glClearNamedFramebufferfv(framebuffer_.name(), GL_COLOR, 0, kNothing);
    glClearNamedFramebufferfi(framebuffer_.name(), GL_DEPTH_STENCIL, 0, 1, 0);
    mark_ = 0;
    glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE);
    glEnable(GL_STENCIL_TEST);
    glStencilOp(GL_KEEP, GL_KEEP, GL_REPLACE);
}

void ShadowCaster::cast(const Light& light, std::span<const glm::vec3> taken, bool alike) {
    const bool bends = bend_->any();
    glUseProgram(bends ? bent_ : straight_);
    if (bends) bend_->use();
    glUniformMatrix4x3fv(kScreenFromStage, 1, GL_FALSE, glm::value_ptr(light.screenFromStage));
    glUniformMatrix3fv(kClipFromScreen, 1, GL_FALSE, glm::value_ptr(light.clipFromScreen));
    glBindVertexArray(vertexArray_.name());
    // The screen has y up, as OpenGL: the warp of an upright picture does not turn over.
    glFrontFace(glm::determinant(light.clipFromScreen) > 0 ? GL_CCW : GL_CW);

    // A sample that this light's shadow has reached is marked, so that no second mesh takes away the same light.
    const GLint none = 0;
    if (++mark_ > kMostMarks) {
        glClearNamedFramebufferiv(framebuffer_.name(), GL_STENCIL, 0, &none);
        mark_ = 1;
    }
    if (!alike) {
        constexpr GLfloat kFarthest = 1;
        glClearNamedFramebufferfv(framebuffer_.name(), GL_DEPTH, 0, &kFarthest);
        glEnable(GL_DEPTH_TEST);
        glDepthFunc(GL_LESS);
        glDepthMask(GL_TRUE);
        glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
        glDisable(GL_STENCIL_TEST);
        draw(taken);
        glEnable(GL_STENCIL_TEST);
        glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
        glDepthFunc(GL_EQUAL);
    }
    glStencilFunc(GL_NOTEQUAL, mark_, 0xff);
    draw(taken);
    glDisable(GL_DEPTH_TEST);
}

void ShadowCaster::draw(std::span<const glm::vec3> taken) {
    FANTASCOPE_CHECK(taken.size() == parts_.size(), "one colour for each piece");
    for (std::size_t i = 0; i < parts_.size(); ++i) {
        const Part& part = parts_[i];
        (part.closed ? glEnable : glDisable)(GL_CULL_FACE);
        glUniform3fv(kTaken, 1, glm::value_ptr(taken[i]));
        glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(part.indexCount), GL_UNSIGNED_INT,
                       reinterpret_cast<const void*>(part.firstIndex * sizeof(std::uint32_t)));
    }
}

void ShadowCaster::end() {
    glDisable(GL_BLEND);
    glDisable(GL_STENCIL_TEST);
}

}  // namespace fantascope::render::gpu
