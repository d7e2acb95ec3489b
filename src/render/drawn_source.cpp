#include "render/drawn_source.h"

#include "render/drawn_caustics.h"
#include "render/drawn_foliage.h"
#include "render/drawn_mirror_ball.h"

#include <utility>

namespace fantascope::render {
namespace {

// A pattern or a solid, straight through the warp.
class DrawnShapes : public DrawnSource {
public:
    DrawnShapes(PlacedSource placed, DrawingTools& tools) : tools_(tools), instances_(std::move(placed)) {}

    void paint(Time time, const Wind& wind, gpu::LayerPicture& picture) override {
        picture.begin();
        instances_.paint(time, wind, DrawnInstances::Bounds::Canvas, tools_.painter);
    }

private:
    DrawingTools& tools_;
    DrawnInstances instances_;
};

using Made = Result<std::unique_ptr<DrawnSource>>;

template <class Source>
Made makeDrawn(const Source& source, const CanvasPlace& place, DrawingTools& tools) {
    PlacedSource placed = TRY(PlacedSource::create(source, place));
    return std::unique_ptr<DrawnSource>(new DrawnShapes(std::move(placed), tools));
}

Made makeDrawn(const FoliageSource& source, const CanvasPlace& place, DrawingTools& tools) {
    return makeDrawnFoliage(source, place, tools);
}
Made makeDrawn(const CausticsSource& source, const CanvasPlace& place, DrawingTools& tools) {
    return makeDrawnCaustics(source, place, tools);
}
Made makeDrawn(const MirrorBallSource& source, const CanvasPlace& place, DrawingTools& tools) {
    return makeDrawnMirrorBall(source, place, tools);
}

}  // namespace

Result<std::unique_ptr<DrawnSource>> makeDrawnSource(const PictureSource& source, const CanvasPlace& place, DrawingTools& tools) {
    return std::visit([&](const auto& kind) { return makeDrawn(kind, place, tools); }, source);
}

DrawnInstances::DrawnInstances(PlacedSource placed) : placed_(std::move(placed)), meshes_(placed_.meshes(), placed_.mirrored()) {}

void DrawnInstances::paint(Time time, const Wind& wind, Bounds bounds, gpu::ShapePainter& painter) {
    constexpr glm::vec3 kEverywhere{0, 0, 1};
    placed_.place(time, wind, meshes_.place());
    painter.paint(meshes_, bounds == Bounds::Canvas ? placed_.canvasEdges()
                                                    : std::array{kEverywhere, kEverywhere, kEverywhere, kEverywhere});
}

}  // namespace fantascope::render
