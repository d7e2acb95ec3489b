#include "render/gpu/canvas_surface.h"

#include <epoxy/gl.h>
#include <fmt/format.h>
#include <glm/gtc/type_ptr.hpp>

namespace fantascope::render::gpu {
namespace {

// Uniform locations of assets/shaders/canvas.vert.
constexpr GLint kClipFromCanvas = 0, kPart = 41;
constexpr int kCells = 48;  // each way, if a mesh bends the canvas: at most Bend::kLongestEdge wide on a canvas of 3 : 2

}  // namespace

Result<CanvasSurface> CanvasSurface::create(const std::string& fragmentShader, const std::string& definitions, const Bend& bend,
                                            ProgramCache& programs) {
    const std::string bent =
        fmt::format("{}#define CELLS {}\n{}", definitions, kCells, TRY(Bend::definitions(programs.folder())));
    return CanvasSurface(TRY(programs.drawing("canvas.vert", fragmentShader, definitions)),
                         TRY(programs.drawing("canvas.vert", fragmentShader, bent)), bend);
}

void CanvasSurface::follow(const CanvasPlace& place) {
    clipFromCanvas_ = clipFromCanvas(1, place);
    const CanvasPart part = place.warp.shown();
    part_ = glm::vec4(part.low, part.high - part.low);
}

void CanvasSurface::use() {
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glUseProgram(bend_->any() ? bent_ : straight_);
    if (bend_->any()) bend_->use();
    glUniformMatrix3fv(kClipFromCanvas, 1, GL_FALSE, glm::value_ptr(clipFromCanvas_));
    glUniform4fv(kPart, 1, glm::value_ptr(part_));
}

void CanvasSurface::draw() {
    glBindVertexArray(noVertices_.name());
    if (bend_->any())
        glDrawArrays(GL_TRIANGLES, 0, 6 * kCells * kCells);
    else
        glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
}

}  // namespace fantascope::render::gpu
