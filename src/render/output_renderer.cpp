#include "render/output_renderer.h"

#include "core/check.h"

#include <array>
#include <utility>

namespace fantascope::render {

Result<std::unique_ptr<OutputRenderer>> OutputRenderer::create(const Options& options, std::span<const PictureSource> sources) {
    auto painter = TRY(gpu::ShapePainter::create(options.shaders));
    std::vector<gpu::LayerPicture> pictures;
    for (std::size_t i = 0; i < gpu::LightSum::kTogether; ++i)
        pictures.push_back(TRY(gpu::LayerPicture::create(options.size, options.samples)));
    auto sum = TRY(gpu::LightSum::create(pictures[0].samples(), options.shaders));
    DrawingTools tools{std::move(painter), gpu::ProgramCache(options.shaders), pictures[0].samples()};
    std::unique_ptr<OutputRenderer> renderer(new OutputRenderer(std::move(tools), std::move(pictures), std::move(sum)));
    for (const PictureSource& source : sources) {
        auto drawn = TRY(makeDrawnSource(source, {options.size, options.corners}, renderer->tools_));
        renderer->sources_.push_back({.drawn = std::move(drawn)});
    }
    return renderer;
}

void OutputRenderer::draw(const show::OutputState& state, const Wind& wind, Time time, unsigned framebuffer) {
    // Light adds: a source that stands in several layers is drawn once with the sum of their opacities.
    for (Source& source : sources_) source.opacity = 0;
    for (const show::LayerState& layer : state.layers) {
        FANTASCOPE_CHECK(layer.source < sources_.size(), "a layer shows a source that the renderer was not given");
        sources_[layer.source].opacity += layer.opacity;
    }

    std::array<gpu::LightSum::Layer, gpu::LightSum::kTogether> painted;
    std::size_t count = 0;
    gpu::Light light = gpu::Light::Alone;
    const auto shine = [&] {
        sum_.shine(framebuffer, std::span(painted).first(count), light);
        count = 0;
        light = gpu::Light::Added;
    };
    for (Source& source : sources_) {
        if (source.opacity <= 0) continue;
        gpu::LayerPicture& picture = pictures_[count];
        source.drawn->paint(time, wind, picture);
        painted[count++] = {&picture, source.opacity};
        if (count == painted.size()) shine();
    }
    if (count > 0) shine();
    if (light == gpu::Light::Alone) gpu::darken(framebuffer);
}

}  // namespace fantascope::render
