#include "render/drawn_caustics.h"

#include "render/canvas_light.h"
#include "render/gpu/paint/caustics_painter.h"
#include "render/source/water.h"

#include <array>
#include <utility>

namespace fantascope::render {
namespace {

// Points of the grid to the shortest wave: between them a wave's light is interpolated.
constexpr double kPointsPerWave = 8;

class DrawnCaustics : public DrawnSource {
public:
    DrawnCaustics(Water water, CanvasLight light, gpu::CausticsPainter rays)
        : water_(std::move(water)), light_(std::move(light)), rays_(std::move(rays)) {}

    void paint(const Moment& moment, gpu::LayerPicture& picture) override {
        water_.at(moment.own, waves_);
        light_.paint(picture, [&] { rays_.paint(waves_); });
    }
    void follow(const CanvasPlace& place) override { light_.follow(place); }

private:
    Water water_;
    std::array<glm::vec4, Water::kWaves> waves_{};
    CanvasLight light_;
    gpu::CausticsPainter rays_;
};

}  // namespace

Result<std::unique_ptr<DrawnSource>> makeDrawnCaustics(const CausticsSource& source, const CanvasPlace& place,
                                                       DrawingTools& tools) {
    const double aspect = source.size.x / source.size.y;
    Water water(source);
    auto light = TRY(CanvasLight::create(aspect, source.light, place, tools));
    auto rays = TRY(gpu::CausticsPainter::create(aspect, water.reach(), water.shortestWave() / kPointsPerWave, Water::kWaves,
                                                 tools.programs));
    return std::unique_ptr<DrawnSource>(new DrawnCaustics(std::move(water), std::move(light), std::move(rays)));
}

}  // namespace fantascope::render
