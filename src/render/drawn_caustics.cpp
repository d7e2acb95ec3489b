#include "render/drawn_caustics.h"

#include "render/gpu/canvas_painter.h"
#include "render/gpu/caustics_painter.h"
#include "render/gpu/light_canvas.h"
#include "render/water.h"

#include <array>
#include <cmath>
#include <utility>

namespace fantascope::render {
namespace {

// Points of the grid to the shortest wave: between them a wave's light is interpolated.
constexpr double kPointsPerWave = 8;

class DrawnCaustics : public DrawnSource {
public:
    DrawnCaustics(const CausticsSource& source, Water water, gpu::LightCanvas canvas, gpu::CausticsPainter rays,
                  gpu::CanvasPainter painter)
        : light_(source.light),
          water_(std::move(water)),
          canvas_(std::move(canvas)),
          rays_(std::move(rays)),
          painter_(std::move(painter)) {}

    void paint(Time time, const Wind&, gpu::LayerPicture& picture) override {
        water_.at(time, waves_);
        canvas_.begin();
        rays_.paint(waves_);
        canvas_.end();
        picture.begin();
        const std::array pictures = {gpu::CanvasPainter::Picture{.texture = canvas_.texture()}};
        painter_.paint(pictures, nullptr, glm::vec3(0), light_);
    }

private:
    glm::vec3 light_;
    Water water_;
    std::array<glm::vec4, Water::kWaves> waves_{};
    gpu::LightCanvas canvas_;
    gpu::CausticsPainter rays_;
    gpu::CanvasPainter painter_;
};

}  // namespace

Result<std::unique_ptr<DrawnSource>> makeDrawnCaustics(const CausticsSource& source, const CanvasPlace& place,
                                                       DrawingTools& tools) {
    const double aspect = source.size.x / source.size.y, rows = std::ceil(canvasRows(aspect, place));
    Water water(source);
    auto canvas = TRY(gpu::LightCanvas::create(glm::ivec2(std::ceil(aspect * rows), rows)));
    auto rays = TRY(gpu::CausticsPainter::create(aspect, water.reach(), water.shortestWave() / kPointsPerWave, Water::kWaves,
                                                 tools.programs));
    auto painter = TRY(gpu::CanvasPainter::create(TRY(clipFromUnitCanvas(aspect, place)), 1, 0, tools.programs));
    return std::unique_ptr<DrawnSource>(
        new DrawnCaustics(source, std::move(water), std::move(canvas), std::move(rays), std::move(painter)));
}

}  // namespace fantascope::render
