#pragma once

#include "render/drawn_source.h"
#include "render/gpu/layer_picture.h"
#include "render/picture_source.h"
#include "show/show_state.h"

#include "core/clock.h"
#include "core/result.h"
#include "core/wind.h"

#include <glm/vec2.hpp>

#include <array>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

namespace fantascope::render {

// Draws one output's picture. What reaches the projector is the canvas, bent by the output's warp, and black around it: shapes
// that sway over the canvas's edge are cut there.
//
// Layers add as light, so their order does not matter. Within a layer the shapes are opaque to each other, the later instance of
// the pattern on top, and a fading layer fades as one picture. Shapes are drawn straight through the warp, without a picture of
// the canvas in between, and their edges smoothed by several samples a pixel that are averaged as light.
//
// Thread: the render thread, with the context of the output's display current in every call: create(), draw() and the destructor.
class OutputRenderer {
public:
    struct Options {
        glm::ivec2 size{0};                 // pixels of the display
        std::array<glm::dvec2, 4> corners;  // where the canvas's corners go, in pixels, from the canvas's top left clockwise
        int samples = 4;                    // a pixel; llvmpipe and every GPU have 4
        std::filesystem::path shaders;      // the folder of the shader files
    };
    // Error: corners that are not those of a picture; a shader that does not compile (its file and the compiler's log); more
    // pixels or samples than this OpenGL has.
    static Result<std::unique_ptr<OutputRenderer>> create(const Options& options, std::span<const PictureSource> sources);

    // Draws what the show shows on this output at show time `time`, in the wind of then, into `framebuffer`, the display's. Layers
    // name sources by their index in create()'s. No allocation once every source has been shown.
    void draw(const show::OutputState& state, const Wind& wind, Time time, unsigned framebuffer);

private:
    struct Source {
        std::unique_ptr<DrawnSource> drawn;
        float opacity = 0;  // in the frame that is being drawn
    };
    OutputRenderer(DrawingTools tools, std::vector<gpu::LayerPicture> pictures, gpu::LightSum sum)
        : tools_(std::move(tools)), pictures_(std::move(pictures)), sum_(std::move(sum)) {}

    DrawingTools tools_;
    std::vector<gpu::LayerPicture> pictures_;  // LightSum::kTogether of them
    gpu::LightSum sum_;
    std::vector<Source> sources_;
};

}  // namespace fantascope::render
