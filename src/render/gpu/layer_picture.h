#pragma once

#include "render/gpu/handles.h"

#include "core/result.h"

#include <glm/vec2.hpp>

#include <filesystem>

namespace fantascope::render::gpu {

// How the light of one layer meets the others.
enum class Light {
    Alone,  // it is the first: what the framebuffer held before is gone
    Added   // as a second projector would add it
};

// The picture of one layer while it is painted, at full opacity, with several samples a pixel for smooth edges and a depth for
// each.
//
// A sample holds the square root of its linear light in 8 bits: nearly the spacing of sRGB, and cheap, where a software OpenGL
// would spend most of a frame on encoding every sample. The samples are averaged as light and become sRGB once a pixel. Thread:
// the context's.
class LayerPicture {
public:
    // Error: more samples or pixels than this OpenGL has; a shader in the folder `shaders` is missing or does not compile.
    static Result<LayerPicture> create(glm::ivec2 size, int samples, const std::filesystem::path& shaders);

    // Makes it the target of drawing, all black.
    void begin();
    // Gives its light times `opacity` to `framebuffer`, which has the same size and stored sRGB values.
    void shine(unsigned framebuffer, float opacity, Light light);

private:
    LayerPicture(glm::ivec2 size, Program resolve) : size_(size), resolve_(std::move(resolve)) {}

    glm::ivec2 size_;
    MultisampleTexture roots_;
    Renderbuffer depth_;
    Framebuffer framebuffer_;
    Program resolve_;
    VertexArray noVertices_;
};

// Makes `framebuffer` black.
void darken(unsigned framebuffer);

}  // namespace fantascope::render::gpu
