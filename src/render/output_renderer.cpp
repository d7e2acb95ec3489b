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
    std::unique_ptr<OutputRenderer> renderer(new OutputRenderer(std::move(painter), std::move(pictures), std::move(sum)));
    for (const PictureSource& source : sources) {
        PlacedSource placed = TRY(PlacedSource::create(source, options.size, options.corners));
        gpu::InstancedMeshes meshes(placed.meshes(), placed.mirrored());
        renderer->sources_.push_back({std::move(placed), std::move(meshes)});
    }
    return renderer;
}

void OutputRenderer::draw(const show::OutputState& state, const Wind& wind, Time time, unsigned framebuffer) {
    // Light adds: a source that stands in several layers is drawn once with the sum of their opacities.
    for (DrawnSource& source : sources_) source.opacity = 0;
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
    for (DrawnSource& source : sources_) {
        if (source.opacity <= 0) continue;
        source.placed.place(time, wind, source.meshes.place());
        gpu::LayerPicture& picture = pictures_[count];
        picture.begin();
        painter_.paint(source.meshes, source.placed.canvasEdges());
        painted[count++] = {&picture, source.opacity};
        if (count == painted.size()) shine();
    }
    if (count > 0) shine();
    if (light == gpu::Light::Alone) gpu::darken(framebuffer);
}

}  // namespace fantascope::render
