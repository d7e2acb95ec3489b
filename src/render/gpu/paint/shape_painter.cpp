#include "render/gpu/paint/shape_painter.h"

#include "render/gpu/shader_program.h"

#include <epoxy/gl.h>
#include <glm/gtc/type_ptr.hpp>

namespace fantascope::render::gpu {
namespace {

// Uniform locations of assets/shaders/shape.vert.
constexpr GLint kInside = 0;

}  // namespace

Result<ShapePainter> ShapePainter::create(const std::filesystem::path& shaders) {
    const std::string bend = TRY(Bend::definitions(shaders));
    return ShapePainter(TRY(loadProgram(shaders / "shape.vert", shaders / "shape.frag")),
                        TRY(loadProgram(shaders / "shape.vert", shaders / "shape.frag", bend)));
}

void ShapePainter::paint(InstancedMeshes& meshes, const std::array<glm::vec3, 4>& inside, const Bend* bend) {
    // Depth is 0 at the viewer and 1 behind everything; see PlacedSource.
    glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LESS);
    const bool bends = bend != nullptr && bend->any();
    glUseProgram(bends ? bent_.name() : straight_.name());
    if (bends) bend->use();
    glUniform3fv(kInside, static_cast<GLsizei>(inside.size()), glm::value_ptr(inside[0]));
    for (GLuint plane = 0; plane < inside.size(); ++plane) glEnable(GL_CLIP_DISTANCE0 + plane);
    meshes.draw();
    for (GLuint plane = 0; plane < inside.size(); ++plane) glDisable(GL_CLIP_DISTANCE0 + plane);
}

}  // namespace fantascope::render::gpu
