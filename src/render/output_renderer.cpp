#include "render/output_renderer.h"

#include "render/drawn_picture.h"

#include "core/check.h"

#include <utility>

namespace fantascope::render {
namespace {

// The place of a picture that lies on a part of the canvas.
CanvasPlace placeOn(const CanvasPlace& canvas, const CanvasPart& part) {
    return {canvas.size, part == CanvasPart() ? canvas.warp : canvas.warp.ofPictureOn(part)};
}

}  // namespace

Result<std::unique_ptr<OutputRenderer>> OutputRenderer::create(const Options& options, const PictureSources& sources) {
    const CanvasPlace place{options.projection.size, options.projection.warp};
    auto painter = TRY(gpu::ShapePainter::create(options.shaders));
    DrawingTools tools{std::move(painter),      gpu::ProgramCache(options.shaders), gpu::Bend(), gpu::Bend(), options.samples,
                       Stopwatch(options.clock)};
    tools.bend.follow(place);
    std::unique_ptr<OutputRenderer> renderer(new OutputRenderer(std::move(tools)));
    renderer->composer_ = TRY(gpu::Composer::create(place.size, options.samples, renderer->tools_.programs, options.gain.get()));
    renderer->tools_.samples = renderer->composer_->samples();
    renderer->size_ = place.size;
    renderer->overlay_ = TRY(gpu::Overlay::create(place.size, renderer->tools_.programs));
    TRY(renderer->composer_->follow(options.projection.light, options.blend));
    for (const auto& [id, source] : sources) {
        const CanvasPart on = placeOf(source, options.projection.canvasAspect);
        auto drawn = TRY(makeDrawnSource(source, placeOn(place, on), renderer->tools_));
        renderer->sources_.add(id, {source, std::move(drawn)});
    }
    return renderer;
}

Result<void> OutputRenderer::follow(const Projection& projection, const std::shared_ptr<const BlendMap>& blend) {
    const CanvasPlace place{projection.size, projection.warp};
    tools_.bend.follow(place);
    for (const auto& [id, shown] : sources_) shown.drawn->follow(placeOn(place, placeOf(shown.source, projection.canvasAspect)));
    return composer_->follow(projection.light, blend);
}

Result<void> OutputRenderer::setUp(const RgbaImage* overlay, const RgbaImage* card) {
    overlay_->show(overlay);
    card_.reset();
    if (card != nullptr) card_ = TRY(makeDrawnCard(ImageSource{std::make_shared<const RgbaImage>(*card)}, size_, tools_));
    return {};
}

Result<void> OutputRenderer::warmUp(unsigned framebuffer) {
    composer_->begin();
    for (const auto& [id, shown] : sources_) shown.drawn->paint(Moment{}, composer_->nextPicture());
    composer_->warmUp(framebuffer);
    return gpu::checkMemory();
}

void OutputRenderer::draw(const show::OutputState& state, const Wind& wind, Time time, unsigned framebuffer) {
    tools_.uploads.reset();
    composer_->correctLight(card_ ? 0 : lightShare_);
    composer_->begin();
    if (card_) {
        card_->paint(Moment{}, composer_->nextPicture());
        composer_->lay(1, show::Blend::Add);
        composer_->finish(framebuffer);
        overlay_->paint(framebuffer);
        return;
    }
    const auto lay = [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            const show::LayerState& layer = state.layers[i];
            const Shown* const shown = sources_.find(layer.source);
            FANTASCOPE_CHECK(shown != nullptr, "a layer shows a source that the renderer was not given");
            if (layer.opacity <= 0) continue;
            shown->drawn->paint({time, time - layer.begun, wind}, composer_->nextPicture());
            composer_->lay(layer.opacity, layer.blend);
        }
    };
    lay(0, state.pictures.empty() ? state.layers.size() : state.pictures[0].first);
    composer_->endPicture(1);
    for (const show::ComposedPicture& picture : state.pictures) {
        if (picture.share <= 0) continue;
        lay(picture.first, picture.last);
        composer_->endPicture(picture.share);
    }
    composer_->finish(framebuffer);
    overlay_->paint(framebuffer);
}

}  // namespace fantascope::render
