#include "render/gpu/paint/caustics_painter.h"

#include <epoxy/gl.h>
#include <fmt/format.h>
#include <glm/gtc/type_ptr.hpp>

#include <cmath>
#include <cstdint>
#include <vector>

namespace fantascope::render::gpu {
namespace {

// Uniform locations of assets/shaders/caustics.vert.
constexpr GLint kColumns = 0, kGrid = 1, kAspect = 2, kWaves = 3;

}  // namespace

Result<CausticsPainter> CausticsPainter::create(double aspect, double margin, double step, int waves, ProgramCache& programs) {
    const unsigned program = TRY(programs.drawing("caustics.vert", "caustics.frag", fmt::format("#define WAVES {}\n", waves)));
    CausticsPainter painter(program, static_cast<float>(aspect));
    const glm::dvec2 size = glm::dvec2(aspect, 1) + 2 * margin;
    const glm::ivec2 cells(std::ceil(size.x / step), std::ceil(size.y / step));
    painter.points_ = cells + 1;
    painter.grid_ = glm::vec4(glm::dvec4(glm::dvec2(-margin), size / glm::dvec2(cells)));

    std::vector<std::uint32_t> indices;
    for (int y = 0; y < cells.y; ++y)
        for (int x = 0; x < cells.x; ++x) {
            const auto first = static_cast<std::uint32_t>(y * painter.points_.x + x);
            const std::uint32_t below = first + static_cast<std::uint32_t>(painter.points_.x);
            indices.insert(indices.end(), {first, first + 1, below, first + 1, below + 1, below});
        }
    painter.indexCount_ = static_cast<int>(indices.size());
    glNamedBufferStorage(painter.indices_.name(), static_cast<GLsizeiptr>(std::span(indices).size_bytes()), indices.data(), 0);
    glVertexArrayElementBuffer(painter.noVertices_.name(), painter.indices_.name());
    return painter;
}

void CausticsPainter::paint(std::span<const glm::vec4> waves) {
    glUseProgram(program_);
    glUniform1i(kColumns, points_.x);
    glUniform4fv(kGrid, 1, glm::value_ptr(grid_));
    glUniform1f(kAspect, aspect_);
    glUniform4fv(kWaves, static_cast<GLsizei>(waves.size()), glm::value_ptr(waves[0]));
    glBindVertexArray(noVertices_.name());
    glDrawElements(GL_TRIANGLES, indexCount_, GL_UNSIGNED_INT, nullptr);
}

}  // namespace fantascope::render::gpu
