#include "render/gpu/shape_painter.h"

#include "render/gpu/shader_program.h"

#include <epoxy/gl.h>

#include <glm/gtc/type_ptr.hpp>

namespace fantascope::render::gpu {
namespace {

// The uniform locations of assets/shaders/shape.vert.
enum : GLint { kOpacity = 0, kInside = 1 };

}  // namespace

Result<ShapePainter> ShapePainter::create(const std::filesystem::path& shaders) {
    return ShapePainter(TRY(loadProgram(shaders / "shape.vert", shaders / "shape.frag")));
}

void ShapePainter::paint(InstancedMeshes& meshes, const std::array<glm::vec3, 4>& inside, float opacity, Light light) {
    glUseProgram(program_.name());
    glUniform1f(kOpacity, opacity);
    glUniform3fv(kInside, static_cast<GLsizei>(inside.size()), glm::value_ptr(inside[0]));
    for (GLuint plane = 0; plane < inside.size(); ++plane) glEnable(GL_CLIP_DISTANCE0 + plane);
    // Depth is 0 at the viewer and 1 behind everything; see PlacedSource.
    glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LESS);
    glDepthMask(GL_TRUE);
    glClear(GL_DEPTH_BUFFER_BIT);
    if (light == Light::Alone) {
        glDisable(GL_BLEND);
        meshes.draw();
    } else {
        // What lies beneath a nearer instance must not add its light: first find the nearest, then add that one alone.
        glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
        meshes.draw();
        glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
        glDepthFunc(GL_EQUAL);
        glDepthMask(GL_FALSE);
        glEnable(GL_BLEND);
        glBlendFunc(GL_ONE, GL_ONE);
        meshes.draw();
        glDepthMask(GL_TRUE);
    }
}

}  // namespace fantascope::render::gpu
