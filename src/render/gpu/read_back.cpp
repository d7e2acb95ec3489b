#include "render/gpu/read_back.h"

#include <epoxy/gl.h>

#include <algorithm>

namespace fantascope::render::gpu {

void readBack(unsigned framebuffer, glm::ivec2 size, RgbaImage& image) {
    if (image.width() != size.x || image.height() != size.y) image = RgbaImage(size.x, size.y);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, size.x, size.y, GL_RGBA, GL_UNSIGNED_BYTE, image.pixels().data());
    // GL's row 0 is at the bottom.
    for (int top = 0, bottom = size.y - 1; top < bottom; ++top, --bottom)
        std::swap_ranges(image.row(top).begin(), image.row(top).end(), image.row(bottom).begin());
}

}  // namespace fantascope::render::gpu
