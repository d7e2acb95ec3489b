#include "render/drawn_source.h"

#include "render/drawn_caustics.h"
#include "render/drawn_foliage.h"
#include "render/drawn_mirror_ball.h"
#include "render/drawn_picture.h"
#include "render/drawn_shadow.h"
#include "render/gpu/paint/canvas_painter.h"

#include <cmath>
#include <utility>

namespace fantascope::render {
namespace {

// A pattern, straight through the warp.
class DrawnPattern : public DrawnSource {
public:
    DrawnPattern(DrawnInstances instances, DrawingTools& tools) : tools_(tools), instances_(std::move(instances)) {}

    void paint(const Moment& moment, gpu::LayerPicture& picture) override {
        picture.begin();
        instances_.paint(moment, tools_);
    }
    void follow(const CanvasPlace& place) override { instances_.follow(place); }

private:
    DrawingTools& tools_;
    DrawnInstances instances_;
};

class DrawnSolid : public DrawnSource {
public:
    DrawnSolid(glm::vec3 colour, gpu::CanvasPainter painter) : colour_(colour), painter_(std::move(painter)) {}

    void paint(const Moment&, gpu::LayerPicture& picture) override {
        picture.begin();
        painter_.paint({}, nullptr, colour_, colour_);
    }
    void follow(const CanvasPlace& place) override { painter_.follow(place); }

private:
    glm::vec3 colour_;
    gpu::CanvasPainter painter_;
};

using Made = Result<std::unique_ptr<DrawnSource>>;

Made makeDrawn(const PatternSource& source, const CanvasPlace& place, DrawingTools& tools) {
    return std::unique_ptr<DrawnSource>(new DrawnPattern(DrawnInstances(source, place, tools.bend), tools));
}

Made makeDrawn(const SolidSource& source, const CanvasPlace& place, DrawingTools& tools) {
    auto painter = TRY(gpu::CanvasPainter::create(0, 0, tools.bend, tools.programs));
    painter.follow(place);
    return std::unique_ptr<DrawnSource>(new DrawnSolid(source.colour, std::move(painter)));
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
Made makeDrawn(const ImageSource& source, const CanvasPlace& place, DrawingTools& tools) {
    return makeDrawnImage(source, place, tools);
}
Made makeDrawn(const VideoSource& source, const CanvasPlace& place, DrawingTools& tools) {
    return makeDrawnVideo(source, place, tools);
}
Made makeDrawn(const CameraSource& source, const CanvasPlace& place, DrawingTools& tools) {
    return makeDrawnCamera(source, place, tools);
}
Made makeDrawn(const ShadowSource& source, const CanvasPlace& place, DrawingTools& tools) {
    return makeDrawnShadow(source, place, tools);
}

}  // namespace

Result<std::unique_ptr<DrawnSource>> makeDrawnSource(const PictureSource& source, const CanvasPlace& place, DrawingTools& tools) {
    return std::visit([&](const auto& kind) { return makeDrawn(kind, place, tools); }, source.picture);
}

DrawnInstances::DrawnInstances(const PatternSource& source, const CanvasPlace& place, const gpu::Bend& bend)
    : placed_(source, place),
      bend_(&bend),
      meshes_(placed_.meshes(bend.any() ? gpu::Bend::kLongestEdge : INFINITY), placed_.mirrored()) {}

DrawnInstances::DrawnInstances(const PatternSource& source, const CanvasPlace& place)
    : placed_(source, place), bend_(nullptr), meshes_(placed_.meshes(), placed_.mirrored()) {}

void DrawnInstances::follow(const CanvasPlace& place) {
    placed_.follow(place);
    meshes_.setMirrored(placed_.mirrored());
}

void DrawnInstances::paint(const Moment& moment, DrawingTools& tools) {
    constexpr glm::vec3 kEverywhere{0, 0, 1};
    tools.uploads.time([&] { placed_.place(moment.own, moment.wind, moment.exchange, meshes_.place()); });
    tools.painter.paint(meshes_,
                        bend_ != nullptr ? placed_.canvasEdges() : std::array{kEverywhere, kEverywhere, kEverywhere, kEverywhere},
                        bend_);
}

}  // namespace fantascope::render
