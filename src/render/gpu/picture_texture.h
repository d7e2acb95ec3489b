#pragma once

#include "render/gpu/handles.h"

#include "core/result.h"
#include "media/image.h"

#include <glm/vec2.hpp>

#include <array>
#include <cstddef>

namespace fantascope::render::gpu {

// Whether a texture has smaller copies of itself, for minified drawing.
enum class Mipmaps { None, All };

// A picture as a texture that is sampled as linear light: sRGB values, colours multiplied by alpha
// as by premultiply(), row 0 at the top. Thread: the context's.
class PictureTexture {
public:
    // A transparent texture. Error: more pixels than OpenGL allows here.
    static Result<PictureTexture> create(glm::ivec2 size, Mipmaps mipmaps);

    // Copies a picture of its size into it.
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

// Changes a texture's picture every frame without stalling the GPU: the pixels go through memory
// that is mapped on both sides. Thread: the context's.
class PictureUploader {
public:
    // Error: OpenGL has no memory left.
    static Result<PictureUploader> create(glm::ivec2 size);

    // Copies `picture` and queues its upload. Picture and texture have the uploader's size. May
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
