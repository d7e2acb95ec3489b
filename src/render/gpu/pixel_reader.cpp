#include "render/gpu/pixel_reader.h"

#include "core/check.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <algorithm>
#include <span>

namespace fantascope::render::gpu {

static_assert(sizeof(Rgba8) == 4, "OpenGL packs its pixels");

Result<PixelReader> PixelReader::create(glm::ivec2 size) {
    PixelReader reader(size);
    const GLsizeiptr bytes = static_cast<GLsizeiptr>(size.x) * size.y * static_cast<GLsizeiptr>(sizeof(Rgba8));
    constexpr GLbitfield kAccess = GL_MAP_READ_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
    glNamedBufferStorage(reader.pixels_.name(), bytes, nullptr, kAccess | GL_CLIENT_STORAGE_BIT);
    reader.mapped_ = static_cast<const Rgba8*>(glMapNamedBufferRange(reader.pixels_.name(), 0, bytes, kAccess));
    if (reader.mapped_ == nullptr) return Error(fmt::format("OpenGL has no memory for a copy of {} x {} pixels", size.x, size.y));
    return reader;
}

void PixelReader::start(unsigned framebuffer) {
    glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer);
    glBindBuffer(GL_PIXEL_PACK_BUFFER, pixels_.name());
    glReadPixels(0, 0, size_.x, size_.y, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
    glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
    copied_.set();
}

void PixelReader::copyTo(RgbaImage& image) const {
    FANTASCOPE_CHECK(image.width() == size_.x && image.height() == size_.y, "the image has the framebuffer's size");
    const std::span all(mapped_, image.pixels().size());
    const auto width = static_cast<std::size_t>(size_.x);
    for (int y = 0; y < size_.y; ++y)
        std::ranges::copy(all.subspan(static_cast<std::size_t>(size_.y - 1 - y) * width, width), image.row(y).begin());
}

}  // namespace fantascope::render::gpu
