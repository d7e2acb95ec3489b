#include "render/gpu/paint/canvas_painter.h"

#include <epoxy/gl.h>
#include <fmt/format.h>
#include <glm/gtc/type_ptr.hpp>

#include <string>

namespace fantascope::render::gpu {
namespace {

// Uniform locations of assets/shaders/canvas.frag.
constexpr GLint kDark = 1, kBright = 2, kPlace = 3;
constexpr GLuint kSharp = 0, kPictures = 1;

}  // namespace

Result<CanvasPainter> CanvasPainter::create(std::size_t pictures, int sharpSamples, const Bend& bend, ProgramCache& programs) {
    const std::string sharp = sharpSamples > 0 ? fmt::format("#define SHARP\n#define SAMPLES {}\n", sharpSamples) : "";
    return CanvasPainter(
        TRY(CanvasSurface::create("canvas.frag", fmt::format("#define LAYERS {}\n{}", pictures, sharp), bend, programs)));
}

void CanvasPainter::paint(std::span<const Picture> pictures, const LayerPicture* sharp, glm::vec3 dark, glm::vec3 bright) {
    surface_.use();
    glUniform3fv(kDark, 1, glm::value_ptr(dark));
    glUniform3fv(kBright, 1, glm::value_ptr(bright));
    for (std::size_t i = 0; i < pictures.size(); ++i) {
        glUniform4fv(kPlace + static_cast<GLint>(i), 1, glm::value_ptr(pictures[i].place));
        glBindTextureUnit(kPictures + static_cast<GLuint>(i), pictures[i].texture);
    }
    if (sharp != nullptr) glBindTextureUnit(kSharp, sharp->texture());
    surface_.draw();
}

}  // namespace fantascope::render::gpu
