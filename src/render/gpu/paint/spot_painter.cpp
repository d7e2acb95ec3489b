#include "render/gpu/paint/spot_painter.h"

#include <epoxy/gl.h>
#include <glm/gtc/type_ptr.hpp>

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace fantascope::render::gpu {
namespace {

// Attribute and uniform locations of assets/shaders/spot.vert.
constexpr GLuint kOutwards = 0, kNormal = 1;
constexpr GLint kBall = 0, kLamp = 1, kMeasures = 2, kCanvas = 3;
constexpr GLuint kCorners = 0;  // the buffer binding point of the vertex array

}  // namespace

Result<SpotPainter> SpotPainter::create(std::span<const Facet> facets, const Scene& scene, ProgramCache& programs) {
    const unsigned program = TRY(programs.drawing("spot.vert", "spot.frag"));
    // Four vertices per facet instead of an instance: a software OpenGL draws every instance
    // separately.
    std::vector<Facet> corners;
    std::vector<std::uint32_t> indices;
    for (const Facet& facet : facets) {
        const auto first = static_cast<std::uint32_t>(corners.size());
        corners.insert(corners.end(), 4, facet);
        indices.insert(indices.end(), {first, first + 1, first + 2, first + 1, first + 3, first + 2});
    }
    SpotPainter painter(program, scene, static_cast<int>(indices.size()));
    glNamedBufferStorage(painter.corners_.name(), static_cast<GLsizeiptr>(std::span(corners).size_bytes()), corners.data(), 0);
    glNamedBufferStorage(painter.indices_.name(), static_cast<GLsizeiptr>(std::span(indices).size_bytes()), indices.data(), 0);
    const GLuint array = painter.vertexArray_.name();
    glVertexArrayElementBuffer(array, painter.indices_.name());
    glVertexArrayVertexBuffer(array, kCorners, painter.corners_.name(), 0, sizeof(Facet));
    for (const auto& [location, offset] : {std::pair(kOutwards, offsetof(Facet, outwards)), {kNormal, offsetof(Facet, normal)}}) {
        glEnableVertexArrayAttrib(array, location);
        glVertexArrayAttribFormat(array, location, 3, GL_FLOAT, GL_FALSE, static_cast<GLuint>(offset));
        glVertexArrayAttribBinding(array, location, kCorners);
    }
    return painter;
}

void SpotPainter::paint(float angle) {
    glUseProgram(program_);
    glUniform3fv(kBall, 1, glm::value_ptr(scene_.ball));
    glUniform3fv(kLamp, 1, glm::value_ptr(scene_.lamp));
    glUniform4f(kMeasures, scene_.ballRadius, scene_.halfFacet, scene_.lampRadius, angle);
    glUniform2fv(kCanvas, 1, glm::value_ptr(scene_.canvas));
    glBindVertexArray(vertexArray_.name());
    glDrawElements(GL_TRIANGLES, indexCount_, GL_UNSIGNED_INT, nullptr);
}

}  // namespace fantascope::render::gpu
