#include "render/drawn_foliage.h"

#include "render/gpu/paint/canvas_painter.h"
#include "render/gpu/paint/convolution.h"
#include "render/source/penumbra.h"

#include "core/check.h"
#include "core/geometry.h"

#include <optional>
#include <utility>
#include <vector>

namespace fantascope::render {
namespace {

// A blur of less than a pixel is left out: a sharp layer's samples smooth its edges as much.
constexpr double kMinBlur = 1;

// One layer of leaves, blurred.
class BlurredLayer {
public:
    static Result<BlurredLayer> create(const ShadowLayer& layer, double rows, DrawingTools& tools) {
        const double aspect = layer.leaves.pattern->aspect();
        const BlurGrid grid = BlurGrid::forFilter(layer.filter, aspect, rows);
        auto convolution = TRY(gpu::Convolution::create(grid.size, grid.filter, grid.block, tools.samples, tools.programs));
        const glm::ivec2 painted = grid.block * (grid.size + 2 * convolution.margin());
        auto picture = TRY(gpu::LayerPicture::create(painted, tools.samples));
        // OpenGL's row 0 is at the bottom. The canvas is painted upside down, so that row 0 of its
        // picture is its top.
        WarpShape upsideDown{.corners = rectangleCorners(grid.block * aspect / grid.pitch, grid.block / grid.pitch)};
        for (glm::dvec2& corner : upsideDown.corners) {
            corner += glm::dvec2(grid.block * (convolution.margin() + 1));
            corner.y = painted.y - corner.y;
        }
        const CanvasPlace place{painted, Warp::of(upsideDown).value()};
        const glm::dvec2 scale = glm::dvec2(aspect, 1) / grid.pitch / glm::dvec2(grid.size), offset = 1.0 / glm::dvec2(grid.size);
        const gpu::CanvasPainter::Picture blurred{convolution.texture(), glm::vec4(scale, offset)};
        return BlurredLayer(DrawnInstances(layer.leaves, place), std::move(picture), std::move(convolution), blurred,
                            layer.holes);
    }

    void draw(const Moment& moment, DrawingTools& tools) {
        picture_.begin();
        instances_.paint(moment, tools);
        convolution_.run(picture_, holes_ ? glm::vec2(0, 1) : glm::vec2(1, -1));
    }
    const gpu::CanvasPainter::Picture& blurred() const { return blurred_; }

private:
    BlurredLayer(DrawnInstances instances, gpu::LayerPicture picture, gpu::Convolution convolution,
                 gpu::CanvasPainter::Picture blurred, bool holes)
        : instances_(std::move(instances)),
          picture_(std::move(picture)),
          convolution_(std::move(convolution)),
          blurred_(blurred),
          holes_(holes) {}

    DrawnInstances instances_;
    gpu::LayerPicture picture_;
    gpu::Convolution convolution_;
    gpu::CanvasPainter::Picture blurred_;
    bool holes_;
};

class DrawnFoliage : public DrawnSource {
public:
    DrawnFoliage(const FoliageSource& source, std::vector<BlurredLayer> blurred, std::vector<DrawnInstances> sharp,
                 std::optional<gpu::LayerPicture> sharpPicture, gpu::CanvasPainter painter, DrawingTools& tools)
        : tools_(tools),
          dark_(source.shadow),
          bright_(source.light),
          blurred_(std::move(blurred)),
          sharp_(std::move(sharp)),
          sharpPicture_(std::move(sharpPicture)),
          painter_(std::move(painter)) {
        for (const BlurredLayer& layer : blurred_) pictures_.push_back(layer.blurred());
    }

    void paint(const Moment& moment, gpu::LayerPicture& picture) override {
        for (BlurredLayer& layer : blurred_) layer.draw(moment, tools_);
        if (sharpPicture_) sharpPicture_->begin();
        for (DrawnInstances& layer : sharp_) layer.paint(moment, tools_);
        picture.begin();
        painter_.paint(pictures_, sharpPicture_ ? &*sharpPicture_ : nullptr, dark_, bright_);
    }

    void follow(const CanvasPlace& place) override {
        for (DrawnInstances& layer : sharp_) layer.follow(place);
        painter_.follow(place);
    }

private:
    DrawingTools& tools_;
    glm::vec3 dark_, bright_;
    std::vector<BlurredLayer> blurred_;
    std::vector<gpu::CanvasPainter::Picture> pictures_;
    std::vector<DrawnInstances> sharp_;  // all in one picture: covered twice is as dark as covered once
    std::optional<gpu::LayerPicture> sharpPicture_;
    gpu::CanvasPainter painter_;
};

}  // namespace

Result<std::unique_ptr<DrawnSource>> makeDrawnFoliage(const FoliageSource& source, const CanvasPlace& place,
                                                      DrawingTools& tools) {
    FANTASCOPE_CHECK(!source.layers.empty(), "foliage has a layer of leaves");
    const double aspect = source.layers[0].leaves.pattern->aspect(), rows = place.warp.canvasRows(aspect);
    std::vector<BlurredLayer> blurred;
    std::vector<DrawnInstances> sharp;
    for (const ShadowLayer& layer : source.layers) {
        if (layer.holes || layer.filter.width * rows >= kMinBlur)
            blurred.push_back(TRY(BlurredLayer::create(layer, rows, tools)));
        else
            sharp.emplace_back(layer.leaves, place, tools.bend);
    }
    std::optional<gpu::LayerPicture> sharpPicture;
    if (!sharp.empty()) sharpPicture = TRY(gpu::LayerPicture::create(place.size, tools.samples));
    auto painter = TRY(gpu::CanvasPainter::create(blurred.size(), sharp.empty() ? 0 : tools.samples, tools.bend, tools.programs));
    painter.follow(place);
    return std::unique_ptr<DrawnSource>(
        new DrawnFoliage(source, std::move(blurred), std::move(sharp), std::move(sharpPicture), std::move(painter), tools));
}

}  // namespace fantascope::render
