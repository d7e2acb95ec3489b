#pragma once

#include "render/gpu/handles.h"

#include "core/result.h"

#include <glm/vec2.hpp>

#include <array>
#include <cstddef>
#include <filesystem>
#include <span>

namespace fantascope::render::gpu {

// The picture of one layer while it is painted, at full opacity, with several samples a pixel for smooth edges and a depth for
// each.
//
// A sample holds the square root of its linear light in 8 bits: nearly the spacing of sRGB, and cheap, where a software OpenGL
// would spend most of a frame on encoding every sample. Its alpha is 1 where something was painted, else 0. Thread: the context's.
class LayerPicture {
public:
    // Error: more samples or pixels than this OpenGL has.
    static Result<LayerPicture> create(glm::ivec2 size, int samples);

    // Makes it the target of drawing, all black and uncovered.
    void begin();

    int samples() const { return samples_; }  // a pixel; at least as many as were asked for
    unsigned texture() const { return roots_.name(); }

private:
    explicit LayerPicture(glm::ivec2 size) : size_(size) {}

    glm::ivec2 size_;
    int samples_ = 0;
    MultisampleTexture roots_;
    Renderbuffer depth_;
    Framebuffer framebuffer_;
};

// How light meets what a framebuffer holds.
enum class Light {
    Alone,  // it is the first: what the framebuffer held before is gone
    Added   // as a second projector would add it
};

// Adds up the light of painted layers: their samples are averaged as light, and the sum becomes sRGB once a pixel. Thread: the
// context's.
class LightSum {
public:
    // As many layers as one pass over the picture takes. In a crossfade there are two; to add a second pass to stored sRGB values
    // costs a software OpenGL more than all the rest of it.
    static constexpr std::size_t kTogether = 2;
    struct Layer {
        const LayerPicture* picture;
        float opacity;
    };

    // `samples`: of every picture that it will be given. Error: a shader in the folder `shaders` is missing or does not compile.
    static Result<LightSum> create(int samples, const std::filesystem::path& shaders);

    // Gives the light of one to kTogether layers to `framebuffer`, which has their size and stored sRGB values.
    void shine(unsigned framebuffer, std::span<const Layer> layers, Light light);

private:
    std::array<Program, kTogether> programs_;  // for one layer, for two, ...
    VertexArray noVertices_;
};

// Makes `framebuffer` black.
void darken(unsigned framebuffer);

}  // namespace fantascope::render::gpu
