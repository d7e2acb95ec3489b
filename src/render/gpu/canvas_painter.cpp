#include "render/gpu/canvas_painter.h"

#include <epoxy/gl.h>
#include <fmt/format.h>
#include <glm/gtc/type_ptr.hpp>

namespace fantascope::render::gpu {
namespace {

// Of assets/shaders/canvas.vert and canvas.frag.
constexpr GLint kClipFromCanvas = 0, kDark = 1, kBright = 2, kPlace = 3;
constexpr GLuint kSharp = 0, kPictures = 1;

}  // namespace

Result<CanvasPainter> CanvasPainter::create(const glm::mat3& clipFromCanvas, std::size_t pictures, int sharpSamples,
                                            ProgramCache& programs) {
    const std::string sharp = sharpSamples > 0 ? fmt::format("#define SHARP\n#define SAMPLES {}\n", sharpSamples) : "";
    const unsigned program =
        TRY(programs.drawing("canvas.vert", "canvas.frag", fmt::format("#define LAYERS {}\n{}", pictures, sharp)));
    return CanvasPainter(program, clipFromCanvas);
}

void CanvasPainter::paint(std::span<const Picture> pictures, const LayerPicture* sharp, glm::vec3 dark, glm::vec3 bright) {
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glUseProgram(program_);
    glUniformMatrix3fv(kClipFromCanvas, 1, GL_FALSE, glm::value_ptr(clipFromCanvas_));
    glUniform3fv(kDark, 1, glm::value_ptr(dark));
    glUniform3fv(kBright, 1, glm::value_ptr(bright));
    for (std::size_t i = 0; i < pictures.size(); ++i) {
        glUniform4fv(kPlace + static_cast<GLint>(i), 1, glm::value_ptr(pictures[i].place));
        glBindTextureUnit(kPictures + static_cast<GLuint>(i), pictures[i].texture);
    }
    if (sharp != nullptr) glBindTextureUnit(kSharp, sharp->texture());
    glBindVertexArray(noVertices_.name());
    glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
}

}  // namespace fantascope::render::gpu
