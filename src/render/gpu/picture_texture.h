#pragma once

#include "render/gpu/handles.h"

#include "core/result.h"
#include "media/image.h"

#include <glm/vec2.hpp>

#include <array>
#include <cstddef>

namespace fantascope::render::gpu {

// Whether a picture has smaller copies of itself, for where it is drawn very small.
enum class Mipmaps { None, All };

// A picture to be looked up as light: sRGB values, colours multiplied by alpha as premultiply()
// does, row 0 at the top. Thread: the context's.
class PictureTexture {
public:
    // Clear. Error: more pixels than this OpenGL has.
    static Result<PictureTexture> create(glm::ivec2 size, Mipmaps mipmaps);

    // Gives it the pixels of a picture of its size.
    void set(const RgbaImage& picture);

    unsigned texture() const { return pixels_.name(); }
    glm::ivec2 size() const { return size_; }

private:
    friend class PictureUploader;
    PictureTexture(glm::ivec2 size, Mipmaps mipmaps) : size_(size), mipmaps_(mipmaps) {}
    void setFrom(const void* pixels);

    glm::ivec2 size_;
    Mipmaps mipmaps_;
    Texture pixels_;
};

// Changes a texture's picture from frame to frame without stopping the drawing: the pixels go by
// way of memory that both sides see. Thread: the context's.
class PictureUploader {
public:
    // Error: OpenGL has no memory left.
    static Result<PictureUploader> create(glm::ivec2 size);

    // Queues it; `picture` is not needed any longer afterwards. Both have the uploader's size. May
    // wait for the upload of three pictures ago.
    void upload(const RgbaImage& picture, PictureTexture& texture);

private:
    static constexpr std::size_t kInFlight = 3;
    explicit PictureUploader(std::size_t bytes) : bytes_(bytes) {}

    std::size_t bytes_;
    Buffer pixels_;
    std::byte* mapped_ = nullptr;  // kInFlight pictures
    std::array<Fence, kInFlight> copied_;
    std::size_t turn_ = 0;
};

}  // namespace fantascope::render::gpu
