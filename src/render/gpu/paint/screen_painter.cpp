#include "render/gpu/paint/screen_painter.h"

#include "theatre/stage/screen.h"

#include <epoxy/gl.h>
#include <fmt/format.h>
#include <glm/gtc/type_ptr.hpp>

#include <string>

namespace fantascope::render::gpu {
namespace {

// Uniform locations of assets/shaders/screen.frag.
constexpr GLint kDark = 1, kBright = 2, kLit = 3, kScreen = 4, kCurve = 5;
constexpr GLuint kTaken = 0;

}  // namespace

Result<ScreenPainter> ScreenPainter::create(int samples, bool curved, const Bend& bend, ProgramCache& programs) {
    std::string definitions;
    if (samples > 0) definitions += fmt::format("#define TAKEN\n#define SAMPLES {}\n", samples);
    if (curved) definitions += fmt::format("#define CURVED\n#define MOST_ARC {:.6f}\n", theatre::Screen::kMostArc);
    return ScreenPainter(curved, TRY(CanvasSurface::create("screen.frag", definitions, bend, programs)));
}

void ScreenPainter::paint(const Screen& screen, unsigned taken) {
    surface_.use();
    glUniform3fv(kDark, 1, glm::value_ptr(screen.dark));
    glUniform3fv(kBright, 1, glm::value_ptr(screen.bright));
    glUniform4fv(kLit, 1, glm::value_ptr(screen.lit));
    glUniform4fv(kScreen, 1, glm::value_ptr(screen.canvas));
    if (curved_) glUniform4fv(kCurve, 1, glm::value_ptr(screen.curve));
    if (taken != 0) glBindTextureUnit(kTaken, taken);
    surface_.draw();
}

}  // namespace fantascope::render::gpu
