#pragma once

#include "render/canvas_warp.h"
#include "render/gpu/instanced_meshes.h"
#include "render/gpu/layer_picture.h"
#include "render/gpu/program_cache.h"
#include "render/gpu/shape_painter.h"
#include "render/picture_source.h"
#include "render/placed_source.h"

#include "core/clock.h"
#include "core/result.h"
#include "core/wind.h"

#include <memory>

namespace fantascope::render {

// What all sources of one output draw with.
struct DrawingTools {
    gpu::ShapePainter painter;
    gpu::ProgramCache programs;
    int samples;  // a pixel, of every layer picture
};

// One picture source as it is drawn on one output. Thread: the context's.
class DrawnSource {
public:
    virtual ~DrawnSource() = default;
    // Paints all of the source as it stands at show time `time`, in the wind of then, at full opacity. `picture` is begun by this. No allocation.
    virtual void paint(Time time, const Wind& wind, gpu::LayerPicture& picture) = 0;
};

// `tools` outlives it. Error: corners that are not those of a picture; a shader that does not compile; more pixels than this OpenGL has.
Result<std::unique_ptr<DrawnSource>> makeDrawnSource(const PictureSource& source, const CanvasPlace& place, DrawingTools& tools);

// A pattern's instances in one picture; what every source that shows a pattern draws it with.
class DrawnInstances {
public:
    explicit DrawnInstances(PlacedSource placed);

    enum class Bounds { Canvas, Picture };  // what cuts shapes that reach over it
    // Paints into the picture that has begun.
    void paint(Time time, const Wind& wind, Bounds bounds, gpu::ShapePainter& painter);

private:
    PlacedSource placed_;
    gpu::InstancedMeshes meshes_;
};

}  // namespace fantascope::render
