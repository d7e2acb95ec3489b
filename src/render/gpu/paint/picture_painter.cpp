#include "render/gpu/paint/picture_painter.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

namespace fantascope::render::gpu {
namespace {

constexpr GLuint kPicture = 0;  // of assets/shaders/picture.frag

}  // namespace

Result<PicturePainter> PicturePainter::create(const Bend& bend, ProgramCache& programs) {
    return PicturePainter(TRY(CanvasSurface::create("picture.frag", fmt::format("#define MOST {}\n", kMaxTaps), bend, programs)));
}

void PicturePainter::paint(const PictureTexture& picture) {
    surface_.use();
    glBindTextureUnit(kPicture, picture.texture());
    surface_.draw();
}

}  // namespace fantascope::render::gpu
