#pragma once

#include "render/canvas/blend_map.h"
#include "render/drawn_source.h"
#include "render/gpu/paint/composer.h"
#include "render/gpu/paint/overlay.h"
#include "render/source/picture_source.h"
#include "show/show_state.h"

#include "core/clock.h"
#include "core/geometry.h"
#include "core/result.h"
#include "core/wind.h"
#include "media/image.h"
#include "media/projection.h"

#include <glm/vec2.hpp>

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

namespace fantascope::render {

// Draws one output's picture. A source's `fit` says how it lies on a canvas of another aspect. The
// projector shows the canvas through the output's warp, and black around it; shapes that sway over
// the canvas's edge are clipped there.
//
// Layers blend in linear light. Within a layer, shapes hide each other, with later instances of the
// pattern on top, and a layer fades as one picture. Shapes are drawn straight through the warp,
// without an intermediate picture of the canvas. Their edges are smoothed by several samples per
// pixel, which are averaged in linear light.
//
// Thread: the render thread, with the context of the output's display current in every call:
// create(), draw() and the destructor.
class OutputRenderer {
public:
    struct Options {
        Projection projection;                    // of the display's pixels
        std::shared_ptr<const BlendMap> blend{};  // its share of the light beside its neighbours; null: all of it
        int samples = 4;                          // per pixel; llvmpipe and every GPU support 4
        std::filesystem::path shaders;            // the folder of the shader files
        const Clock* clock = nullptr;             // times uploads; null: they are not timed
        std::shared_ptr<const GreyImage> gain{};  // the light correction, by projector pixel, linear; null: none
    };
    // Error: a shader does not compile (names its file and gives the compiler's log), or more
    // pixels or samples than OpenGL allows here.
    static Result<std::unique_ptr<OutputRenderer>> create(const Options& options, const PictureSources& sources);

    // Applies new settings of the projector; its size must stay. If the warp had no mesh when the
    // renderer was made, a new mesh bends only the corners of large triangles; make a new renderer
    // to have it exact. Error: a shader does not compile.
    Result<void> follow(const Projection& projection, const std::shared_ptr<const BlendMap>& blend);
    // Sets what a technician sees while setting the output up. `card`: replaces the show; opaque
    // stored sRGB values that pass the projector's colours and the blend but not the warp; null:
    // the show. `overlay`: lies over everything in the projector's own pixels; stored values,
    // colours multiplied by alpha; null: none. Both are copied. Error: a shader does not compile,
    // or more pixels than OpenGL allows here.
    Result<void> setUp(const RgbaImage* overlay, const RgbaImage* card);
    // How far the light correction is faded in from now on, 0..1. A card is shown without it.
    void correctLight(float share) { lightShare_ = share; }
    // As Composer::moveMaps: for a warp that follows a projector that has moved.
    void moveMaps(const std::optional<Homography>& moved) { composer_->moveMaps(moved); }
    // Makes ready to draw an exchange of a source's pattern: `pattern` has its rests. Layers that
    // name it show it from then on; until then, and if it was never made ready, they show the
    // source's own pattern. Exchanges before the one before are dropped, and one of the same number
    // with another pattern. Does nothing if it is ready, or if there is no such source.
    // Error: OpenGL has no memory left.
    Result<void> exchange(show::SourceId source, int number, const PatternSource& pattern);
    // Makes ready to draw another source, and draws it once. Error: as create(), or OpenGL has no
    // memory left.
    Result<void> add(show::SourceId source, const PictureSource& picture);
    bool has(show::SourceId source) const { return sources_.find(source) != nullptr; }
    // Forgets all sources but these, which no layer names any more, and their exchanges.
    void dropAllBut(const PictureSources& sources);
    // Draws every source once and every combination of layers, so that nothing is compiled during
    // the show. Error: OpenGL has no memory left.
    Result<void> warmUp(unsigned framebuffer);
    // Draws the output's state at show time `time`, in the wind of that time, into the display's
    // `framebuffer`. Layers name sources of create() and add(). Does not allocate once every source
    // has been shown.
    void draw(const show::OutputState& state, const Wind& wind, Time time, unsigned framebuffer);
    // How long the last draw() spent on sending instances and pictures to the GPU.
    Time uploading() const { return tools_.uploads.sum(); }

private:
    explicit OutputRenderer(DrawingTools tools) : tools_(std::move(tools)) {}

    struct Shown {
        PictureSource source;  // for its place on the canvas
        std::unique_ptr<DrawnSource> drawn;
    };

    // An exchange of a source's pattern.
    struct Exchanged {
        show::SourceId source;
        int number;
        std::shared_ptr<const pattern::ShapePattern> pattern;
        Shown shown;
    };
    DrawnSource& drawnOf(const show::LayerState& layer);

    DrawingTools tools_;
    std::optional<gpu::Composer> composer_;
    show::BySource<Shown> sources_;
    std::vector<Exchanged> exchanges_;
    CanvasPlace place_;        // of the canvas
    double canvasAspect_ = 0;  // as Projection has it
    glm::ivec2 size_{0};
    float lightShare_ = 1;
    std::optional<gpu::Overlay> overlay_;
    std::unique_ptr<DrawnSource> card_;  // null: the show
};

}  // namespace fantascope::render
