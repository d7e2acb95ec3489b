#include "render/gpu/paint/overlay.h"

#include "core/check.h"

#include <epoxy/gl.h>

namespace fantascope::render::gpu {

Result<Overlay> Overlay::create(glm::ivec2 size, ProgramCache& programs) {
    return Overlay(size, TRY(programs.drawing("compose.vert", "overlay.frag")));
}

void Overlay::show(const RgbaImage* picture) {
    if (picture == nullptr) return picture_.reset();
    FANTASCOPE_CHECK(glm::ivec2(picture->width(), picture->height()) == size_, "the overlay has the projector's size");
    if (!picture_) {
        picture_ = std::make_unique<Texture>();
        glTextureStorage2D(picture_->name(), 1, GL_RGBA8, size_.x, size_.y);
    }
    glTextureSubImage2D(picture_->name(), 0, 0, 0, size_.x, size_.y, GL_RGBA, GL_UNSIGNED_BYTE, picture->pixels().data());
}

void Overlay::paint(unsigned framebuffer) {
    if (!picture_) return;
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer);
    glViewport(0, 0, size_.x, size_.y);
    glDisable(GL_FRAMEBUFFER_SRGB);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    glUseProgram(program_);
    glBindTextureUnit(0, picture_->name());
    glBindVertexArray(noVertices_.name());
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glDisable(GL_BLEND);
}

}  // namespace fantascope::render::gpu
