#include "render/output_renderer.h"

#include "core/check.h"

#include <utility>

namespace fantascope::render {

Result<std::unique_ptr<OutputRenderer>> OutputRenderer::create(const Options& options, std::span<const PictureSource> sources) {
    auto picture = TRY(gpu::LayerPicture::create(options.size, options.samples, options.shaders));
    auto painter = TRY(gpu::ShapePainter::create(options.shaders));
    std::unique_ptr<OutputRenderer> renderer(new OutputRenderer(std::move(picture), std::move(painter)));
    for (const PictureSource& source : sources) {
        PlacedSource placed = TRY(PlacedSource::create(source, options.size, options.corners));
        gpu::InstancedMeshes meshes(placed.meshes(), placed.mirrored());
        renderer->sources_.push_back({std::move(placed), std::move(meshes)});
    }
    return renderer;
}

void OutputRenderer::draw(const show::OutputState& state, Time time, unsigned framebuffer) {
    // Light adds: a source that stands in several layers is drawn once with the sum of their opacities.
    for (DrawnSource& source : sources_) source.opacity = 0;
    for (const show::LayerState& layer : state.layers) {
        FANTASCOPE_CHECK(layer.source < sources_.size(), "a layer shows a source that the renderer was not given");
        sources_[layer.source].opacity += layer.opacity;
    }

    gpu::Light light = gpu::Light::Alone;
    for (DrawnSource& source : sources_) {
        if (source.opacity <= 0) continue;
        source.placed.place(time, source.meshes.place());
        picture_.begin();
        painter_.paint(source.meshes, source.placed.canvasEdges());
        picture_.shine(framebuffer, source.opacity, light);
        light = gpu::Light::Added;
    }
    if (light == gpu::Light::Alone) gpu::darken(framebuffer);
}

}  // namespace fantascope::render
