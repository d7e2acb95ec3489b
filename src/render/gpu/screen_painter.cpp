#include "render/gpu/screen_painter.h"

#include <epoxy/gl.h>
#include <fmt/format.h>
#include <glm/gtc/type_ptr.hpp>

#include <string>

namespace fantascope::render::gpu {
namespace {

// Of assets/shaders/screen.frag.
constexpr GLint kDark = 1, kBright = 2, kLit = 3;
constexpr GLuint kTaken = 0;

}  // namespace

Result<ScreenPainter> ScreenPainter::create(int samples, const Bend& bend, ProgramCache& programs) {
    const std::string taken = samples > 0 ? fmt::format("#define TAKEN\n#define SAMPLES {}\n", samples) : "";
    return ScreenPainter(TRY(CanvasSurface::create("screen.frag", taken, bend, programs)));
}

void ScreenPainter::paint(const Screen& screen, unsigned taken) {
    surface_.use();
    glUniform3fv(kDark, 1, glm::value_ptr(screen.dark));
    glUniform3fv(kBright, 1, glm::value_ptr(screen.bright));
    glUniform4fv(kLit, 1, glm::value_ptr(screen.lit));
    if (taken != 0) glBindTextureUnit(kTaken, taken);
    surface_.draw();
}

}  // namespace fantascope::render::gpu
