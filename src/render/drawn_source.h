#pragma once

#include "render/canvas/canvas_warp.h"
#include "render/gpu/instanced_meshes.h"
#include "render/gpu/layer_picture.h"
#include "render/gpu/paint/shape_painter.h"
#include "render/gpu/program_cache.h"
#include "render/placed_source.h"
#include "render/source/picture_source.h"
#include "render/source/stopwatch.h"

#include "core/clock.h"
#include "core/result.h"
#include "core/wind.h"

#include <memory>

namespace fantascope::render {

// What all sources of one output share for drawing.
struct DrawingTools {
    gpu::ShapePainter painter;
    gpu::ProgramCache programs;
    gpu::Bend bend;      // of the output's warp
    gpu::Bend straight;  // for what the warp must not bend
    int samples;         // per pixel, of every layer picture
    Stopwatch uploads;   // time spent on sending instances and pictures to the GPU
};

// The moment that a layer is drawn for.
struct Moment {
    Time own{};      // the source's own time: cue time, unless it plays at a speed of its own
    Time ofLayer{};  // its own time since it came onto the output
    Wind wind{};
    show::PatternExchange exchange{};  // which patterns of the source are seen
};

// One picture source as it is drawn on one output. Thread: the context's.
class DrawnSource {
public:
    virtual ~DrawnSource() = default;
    // Begins `picture` and paints the whole source into it as it is at that moment, at full
    // opacity. Does not allocate.
    virtual void paint(const Moment& moment, gpu::LayerPicture& picture) = 0;
    // From now on the output shows its canvas at `place`. The tools' bend is updated by its owner.
    virtual void follow(const CanvasPlace& place) = 0;
};

// `tools` outlives the result. Error: a shader does not compile, or a picture has more pixels than
// OpenGL allows here.
Result<std::unique_ptr<DrawnSource>> makeDrawnSource(const PictureSource& source, const CanvasPlace& place, DrawingTools& tools);

// A pattern's instances in one picture. Every source that shows a pattern draws it by this.
class DrawnInstances {
public:
    // For an output: clipped at the edges of the canvas's shown part, and bent by the tools' mesh.
    DrawnInstances(const PatternSource& source, const CanvasPlace& place, const gpu::Bend& bend);
    // For a picture of the canvas, clipped by that picture alone.
    DrawnInstances(const PatternSource& source, const CanvasPlace& place);

    void follow(const CanvasPlace& place);
    // Paints into the current layer picture.
    void paint(const Moment& moment, DrawingTools& tools);

private:
    PlacedSource placed_;
    const gpu::Bend* bend_;  // null: for a picture of the canvas
    gpu::InstancedMeshes meshes_;
};

}  // namespace fantascope::render
