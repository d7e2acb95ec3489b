#include "render/gpu/picture_texture.h"

#include "core/check.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>

namespace fantascope::render::gpu {
Result<PictureTexture> PictureTexture::create(glm::ivec2 size, Mipmaps mipmaps) {
    GLint largest = 0;
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
    if (std::min(size.x, size.y) < 1 || std::max(size.x, size.y) > largest)
        return Error(
            fmt::format("a picture of {} x {} pixels: OpenGL has at most {} per dimension here", size.x, size.y, largest));
    PictureTexture picture(size, mipmaps);
    const GLuint texture = picture.pixels_.name();
    const GLsizei levels = mipmaps == Mipmaps::None ? 1 : std::bit_width(static_cast<unsigned>(std::max(size.x, size.y)));
    glTextureStorage2D(texture, levels, GL_SRGB8_ALPHA8, size.x, size.y);
    glTextureParameteri(texture, GL_TEXTURE_MIN_FILTER, mipmaps == Mipmaps::None ? GL_LINEAR : GL_LINEAR_MIPMAP_LINEAR);
    glTextureParameteri(texture, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTextureParameteri(texture, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    for (GLint level = 0; level < levels; ++level) glClearTexImage(texture, level, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
    return picture;
}

void PictureTexture::set(const RgbaImage& picture) {
    FANTASCOPE_CHECK(glm::ivec2(picture.width(), picture.height()) == size_, "the picture has the texture's size");
    setFrom(picture.pixels().data());
}

void PictureTexture::setFrom(const void* pixels) {
    glTextureSubImage2D(pixels_.name(), 0, 0, 0, size_.x, size_.y, GL_RGBA, GL_UNSIGNED_BYTE, pixels);
    if (mipmaps_ == Mipmaps::All) glGenerateTextureMipmap(pixels_.name());
}

Result<PictureUploader> PictureUploader::create(glm::ivec2 size) {
    PictureUploader uploader(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) * sizeof(Rgba8));
    const auto bytes = static_cast<GLsizeiptr>(kInFlight * uploader.bytes_);
    constexpr GLbitfield kAccess = GL_MAP_WRITE_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
    glNamedBufferStorage(uploader.pixels_.name(), bytes, nullptr, kAccess | GL_CLIENT_STORAGE_BIT);
    uploader.mapped_ = static_cast<std::byte*>(glMapNamedBufferRange(uploader.pixels_.name(), 0, bytes, kAccess));
    if (uploader.mapped_ == nullptr)
        return Error(fmt::format("OpenGL has no memory for uploading {} x {} pixels", size.x, size.y));
    return uploader;
}

void PictureUploader::upload(const RgbaImage& picture, PictureTexture& texture) {
    FANTASCOPE_CHECK(std::as_bytes(picture.pixels()).size() == bytes_, "the picture has the uploader's size");
    turn_ = (turn_ + 1) % kInFlight;
    copied_[turn_].wait();
    const std::size_t offset = turn_ * bytes_;
    std::memcpy(mapped_ + offset, picture.pixels().data(), bytes_);
    glBindBuffer(GL_PIXEL_UNPACK_BUFFER, pixels_.name());
    texture.setFrom(reinterpret_cast<const void*>(offset));
    glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    copied_[turn_].set();
}

}  // namespace fantascope::render::gpu
