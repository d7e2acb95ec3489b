#include "render/gpu/paint/shadow_caster.h"

#include "core/check.h"

#include <epoxy/gl.h>
#include <fmt/format.h>
#include <glm/gtc/type_ptr.hpp>
#include <glm/matrix.hpp>

#include <cstddef>

namespace fantascope::render::gpu {
namespace {

// Buffer bindings and uniform locations of assets/shaders/skin.comp.
constexpr GLuint kAtRest = 0, kMoved = 1;
constexpr GLint kRange = 0, kMotions = 1;
constexpr unsigned kTogether = 64;  // vertices per work group

// Attribute and uniform locations of assets/shaders/shadow.vert and shadow.frag.
constexpr GLuint kPosition = 0;
constexpr GLint kScreenFromStage = 0, kClipFromScreen = 1, kColour = 2, kInside = 3, kCurve = 7;

static_assert(sizeof(ShadowCaster::Vertex) == 8 * sizeof(float), "the shader reads two vectors per vertex");

}  // namespace

Result<ShadowCaster> ShadowCaster::create(std::span<const Piece> pieces, bool curved, const Bend& bend, ProgramCache& programs) {
    ShadowCaster caster(curved, bend);
    const auto made = [&](const std::string& definitions) -> Result<Programs> {
        const std::string bent = definitions + TRY(Bend::definitions(programs.folder()));
        const auto straight = TRY(programs.drawing("shadow.vert", "shadow.frag", definitions));
        const auto bending = TRY(programs.drawing("shadow.vert", "shadow.frag", bent));
        return Programs{straight, bending};
    };
    caster.skin_ = TRY(programs.compute("skin.comp", fmt::format("#define JOINTS {}\n", kMaxJoints)));
    const std::string screen = curved ? "#define CURVED\n" : "";
    caster.anywhere_ = TRY(made(screen));
    caster.inside_ = TRY(made(screen + "#define INSIDE\n"));

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

void ShadowCaster::moved() { glMemoryBarrier(GL_VERTEX_ATTRIB_ARRAY_BARRIER_BIT); }

void ShadowCaster::paint(const Light& light, std::span<const glm::vec3> colours, const std::array<glm::vec3, 4>& inside) {
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LESS);
    for (GLuint plane = 0; plane < inside.size(); ++plane) glEnable(GL_CLIP_DISTANCE0 + plane);
    draw(inside_, light, colours, &inside);
    for (GLuint plane = 0; plane < inside.size(); ++plane) glDisable(GL_CLIP_DISTANCE0 + plane);
}

void ShadowCaster::draw(const Light& light, std::span<const glm::vec3> colours) { draw(anywhere_, light, colours, nullptr); }

void ShadowCaster::draw(const Programs& programs, const Light& light, std::span<const glm::vec3> colours,
                        const std::array<glm::vec3, 4>* inside) {
    FANTASCOPE_CHECK(colours.size() == parts_.size(), "there is one colour per piece");
    // Depth is 0 at the light.
    glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    const bool bends = bend_->any();
    glUseProgram(bends ? programs.bent : programs.straight);
    if (bends) bend_->use();
    glUniformMatrix4x3fv(kScreenFromStage, 1, GL_FALSE, glm::value_ptr(light.screenFromStage));
    glUniformMatrix3fv(kClipFromScreen, 1, GL_FALSE, glm::value_ptr(light.clipFromScreen));
    if (curved_) glUniform4fv(kCurve, 1, glm::value_ptr(light.curve));
    if (inside != nullptr) glUniform3fv(kInside, static_cast<GLsizei>(inside->size()), glm::value_ptr((*inside)[0]));
    glBindVertexArray(vertexArray_.name());
    // Screen and OpenGL have y up, so the warp of an upright picture does not flip.
    glFrontFace(glm::determinant(light.clipFromScreen) > 0 ? GL_CCW : GL_CW);
    for (std::size_t i = 0; i < parts_.size(); ++i) {
        const Part& part = parts_[i];
        (part.closed ? glEnable : glDisable)(GL_CULL_FACE);
        glUniform3fv(kColour, 1, glm::value_ptr(colours[i]));
        glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(part.indexCount), GL_UNSIGNED_INT,
                       reinterpret_cast<const void*>(part.firstIndex * sizeof(std::uint32_t)));
    }
}

}  // namespace fantascope::render::gpu
