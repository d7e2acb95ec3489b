#include "render/output_renderer.h"

#include "render/drawn_picture.h"

#include "core/check.h"

#include <algorithm>
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
    renderer->place_ = place;
    renderer->canvasAspect_ = options.projection.canvasAspect;
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
    place_ = {projection.size, projection.warp};
    canvasAspect_ = projection.canvasAspect;
    tools_.bend.follow(place_);
    const auto follow = [&](const Shown& shown) { shown.drawn->follow(placeOn(place_, placeOf(shown.source, canvasAspect_))); };
    for (const auto& [id, shown] : sources_) follow(shown);
    for (const Exchanged& exchanged : exchanges_) follow(exchanged.shown);
    return composer_->follow(projection.light, blend);
}

Result<void> OutputRenderer::setUp(const RgbaImage* overlay, const RgbaImage* card) {
    overlay_->show(overlay);
    card_.reset();
    if (card != nullptr) card_ = TRY(makeDrawnCard(ImageSource{std::make_shared<const RgbaImage>(*card)}, size_, tools_));
    return {};
}

Result<void> OutputRenderer::exchange(show::SourceId source, int number, const PatternSource& pattern) {
    const Shown* const own = sources_.find(source);
    const auto isIt = [&](const Exchanged& each) {
        return each.source == source && each.number == number && each.pattern == pattern.pattern;
    };
    if (own == nullptr || std::ranges::any_of(exchanges_, isIt)) return {};
    std::erase_if(exchanges_, [&](const Exchanged& each) {
        return each.source == source && (each.number < number - 1 || each.number == number);
    });
    const PictureSource picture(pattern, own->source.fit);
    auto drawn = TRY(makeDrawnSource(picture, placeOn(place_, placeOf(picture, canvasAspect_)), tools_));
    exchanges_.push_back({source, number, pattern.pattern, {picture, std::move(drawn)}});
    return gpu::checkMemory();
}

Result<void> OutputRenderer::add(show::SourceId source, const PictureSource& picture) {
    auto drawn = TRY(makeDrawnSource(picture, placeOn(place_, placeOf(picture, canvasAspect_)), tools_));
    composer_->begin();
    drawn->paint(Moment{}, composer_->nextPicture());
    sources_.add(source, {picture, std::move(drawn)});
    return gpu::checkMemory();
}

void OutputRenderer::dropAllBut(const PictureSources& sources) {
    std::erase_if(exchanges_, [&](const Exchanged& each) { return sources.find(each.source) == nullptr; });
    sources_.eraseIf([&](show::SourceId id) { return sources.find(id) == nullptr; });
}

// What shows a layer: the exchange that it names, or the source itself.
DrawnSource& OutputRenderer::drawnOf(const show::LayerState& layer) {
    for (const Exchanged& exchanged : exchanges_)
        if (exchanged.source == layer.source && exchanged.number == layer.exchange.number) return *exchanged.shown.drawn;
    const Shown* const shown = sources_.find(layer.source);
    FANTASCOPE_CHECK(shown != nullptr, "a layer shows a source that the renderer was not given");
    return *shown->drawn;
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
            if (layer.opacity <= 0) continue;
            const Time own = time - layer.behind;
            drawnOf(layer).paint({own, own - layer.begun, wind, layer.exchange}, composer_->nextPicture());
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
