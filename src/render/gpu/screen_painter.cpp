#include "render/gpu/screen_painter.h"

#include <epoxy/gl.h>
#include <fmt/format.h>
#include <glm/gtc/type_ptr.hpp>

namespace fantascope::render::gpu {
namespace {

// Of assets/shaders/screen.frag.
constexpr GLint kDark = 1, kBright = 2, kLit = 3;
constexpr GLuint kTaken = 0;

}  // namespace

Result<ScreenPainter> ScreenPainter::create(int samples, const Bend& bend, ProgramCache& programs) {
    return ScreenPainter(TRY(CanvasSurface::create("screen.frag", fmt::format("#define SAMPLES {}\n", samples), bend, programs)));
}

void ScreenPainter::paint(unsigned taken, glm::vec3 dark, glm::vec3 bright, glm::vec4 lit) {
    surface_.use();
    glUniform3fv(kDark, 1, glm::value_ptr(dark));
    glUniform3fv(kBright, 1, glm::value_ptr(bright));
    glUniform4fv(kLit, 1, glm::value_ptr(lit));
    glBindTextureUnit(kTaken, taken);
    surface_.draw();
}

}  // namespace fantascope::render::gpu
