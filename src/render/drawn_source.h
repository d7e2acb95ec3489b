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

// What all sources of one output draw with.
struct DrawingTools {
    gpu::ShapePainter painter;
    gpu::ProgramCache programs;
    gpu::Bend bend;      // of the output's warp
    gpu::Bend straight;  // for what no warp bends
    int samples;         // a pixel, of every layer picture
    Stopwatch uploads;   // of what goes to the GPU anew in a frame: instances, pictures
};

// What a layer is drawn for.
struct Moment {
    Time show{};     // show time
    Time ofLayer{};  // since the source came onto the output
    Wind wind{};
};

// One picture source as it is drawn on one output. Thread: the context's.
class DrawnSource {
public:
    virtual ~DrawnSource() = default;
    // Paints all of the source as it stands at that moment, at full opacity. `picture` is begun by
    // this. No allocation.
    virtual void paint(const Moment& moment, gpu::LayerPicture& picture) = 0;
    // The output shows its canvas elsewhere from now on; the tools' bend follows by itself.
    virtual void follow(const CanvasPlace& place) = 0;
};

// `tools` outlives it. Error: a shader that does not compile; more pixels than this OpenGL has.
Result<std::unique_ptr<DrawnSource>> makeDrawnSource(const PictureSource& source, const CanvasPlace& place, DrawingTools& tools);

// A pattern's instances in one picture; what every source that shows a pattern draws it with.
class DrawnInstances {
public:
    // Straight onto an output: cut at the edges of the canvas's shown part, bent by the tools'
    // mesh.
    DrawnInstances(const PatternSource& source, const CanvasPlace& place, const gpu::Bend& bend);
    // Into a picture of the canvas, cut by nothing but the picture.
    DrawnInstances(const PatternSource& source, const CanvasPlace& place);

    void follow(const CanvasPlace& place);
    // Paints into the picture that has begun.
    void paint(const Moment& moment, DrawingTools& tools);

private:
    PlacedSource placed_;
    const gpu::Bend* bend_;  // null: into a picture of the canvas
    gpu::InstancedMeshes meshes_;
};

}  // namespace fantascope::render
