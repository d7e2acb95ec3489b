#pragma once

#include "render/canvas/blend_map.h"
#include "render/drawn_source.h"
#include "render/gpu/paint/composer.h"
#include "render/gpu/paint/overlay.h"
#include "render/source/picture_source.h"
#include "show/show_state.h"

#include "core/clock.h"
#include "core/result.h"
#include "core/wind.h"
#include "media/image.h"
#include "media/projection.h"

#include <glm/vec2.hpp>

#include <filesystem>
#include <memory>
#include <optional>

namespace fantascope::render {

// Draws one output's picture. A source of another shape than the canvas lies on it as its `fit`
// says. What reaches the projector is the canvas, bent by the output's warp, and black around it:
// shapes that sway over the canvas's edge are cut there.
//
// Layers blend in linear light. Within a layer the shapes are opaque to each other, the later
// instance of the pattern on top, and a fading layer fades as one picture. Shapes are drawn
// straight through the warp, without a picture of the canvas in between, and their edges smoothed
// by several samples a pixel that are averaged as light.
//
// Thread: the render thread, with the context of the output's display current in every call:
// create(), draw() and the destructor.
class OutputRenderer {
public:
    struct Options {
        Projection projection;                    // of the display's pixels
        std::shared_ptr<const BlendMap> blend{};  // what it gives to each pixel beside its neighbours; null: all of its light
        int samples = 4;                          // a pixel; llvmpipe and every GPU have 4
        std::filesystem::path shaders;            // the folder of the shader files
        const Clock* clock = nullptr;             // by which uploads are timed; null: they are not
    };
    // Error: a shader that does not compile (its file and the compiler's log); more pixels or
    // samples than this OpenGL has.
    static Result<std::unique_ptr<OutputRenderer>> create(const Options& options, const PictureSources& sources);

    // The projector is set otherwise from now on, its size aside. A mesh that comes where there was
    // none bends the corners of triangles that were made for a straight canvas: make another
    // renderer to have it exact. Error: a shader does not compile.
    Result<void> follow(const Projection& projection, const std::shared_ptr<const BlendMap>& blend);
    // What a technician is shown. `card`: in place of the show, opaque stored sRGB values that pass
    // the projector's colours and the blend but no warp; null: the show. `overlay`: in the
    // projector's own pixels over all of that, stored values, colours multiplied by alpha; null:
    // none. Both are copied. Error: a shader does not compile; more pixels than this OpenGL has.
    Result<void> setUp(const RgbaImage* overlay, const RgbaImage* card);
    // Draws every source once and every way in which layers may come together, so that nothing is
    // compiled while people watch. Error: OpenGL has no memory left.
    Result<void> warmUp(unsigned framebuffer);
    // Draws what the show shows on this output at show time `time`, in the wind of then, into
    // `framebuffer`, the display's. Layers show sources of create()'s. No allocation once every
    // source has been shown.
    void draw(const show::OutputState& state, const Wind& wind, Time time, unsigned framebuffer);
    // How much of the draw() before was spent on bringing instances and pictures to the GPU.
    Time uploading() const { return tools_.uploads.sum(); }

private:
    explicit OutputRenderer(DrawingTools tools) : tools_(std::move(tools)) {}

    struct Shown {
        PictureSource source;  // for its place on the canvas
        std::unique_ptr<DrawnSource> drawn;
    };

    DrawingTools tools_;
    std::optional<gpu::Composer> composer_;
    show::BySource<Shown> sources_;
    glm::ivec2 size_{0};
    std::optional<gpu::Overlay> overlay_;
    std::unique_ptr<DrawnSource> card_;  // null: the show
};

}  // namespace fantascope::render
