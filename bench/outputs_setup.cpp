#include "drivers/registry.h"

#include "core/check.h"
#include "core/config/config.h"
#include "outputs.h"
#include "source_folder.h"

#include <fmt/format.h>
#include <sys/resource.h>

namespace fantascope::render {

void must(const Result<void>& result) { FANTASCOPE_CHECK(result.has_value(), result.error().message()); }

double processorSeconds() {
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    const auto of = [](const timeval& time) {
        return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
    };
    return of(usage.ru_utime) + of(usage.ru_stime);
}

std::unique_ptr<DisplaySink> opened(const Settings& settings, int number, Clock& clock) {
    const ConfigNode options = valueOf(ConfigNode::parse("driver: " + settings.driver, "bench"));
    const std::string name = fmt::format("output {}", number);
    auto sink = valueOf(drivers::openDisplay(options, {name, {settings.width, settings.height}, settings.rate}, {clock}));
    FANTASCOPE_CHECK(sink->poll(), sink->status().detail);
    must(sink->makeCurrent());
    return sink;
}

std::vector<Variant> variants() {
    const auto nothing = [](OutputRenderer::Options&) {};
    const auto dither = [](OutputRenderer::Options& o) { o.projection.light.dither = true; };
    const auto gamma = [](OutputRenderer::Options& o) { o.projection.light.gamma = 2.2; };
    const auto tint = [](OutputRenderer::Options& o) { o.projection.light.white = {1, 0.97, 0.92}; };
    const auto table = [](OutputRenderer::Options& o) {
        constexpr int kSide = 33;
        ColourCube cube{kSide, glm::vec3(0), glm::vec3(1), {}};
        for (int i = 0; i < kSide * kSide * kSide; ++i)
            cube.colours.push_back(glm::vec3(i % kSide, i / kSide % kSide, i / kSide / kSide) / static_cast<float>(kSide - 1));
        o.projection.light.cube = std::make_shared<const ColourCube>(std::move(cube));
    };
    const auto blend = [](OutputRenderer::Options& o) {
        o.blend = std::make_shared<const BlendMap>(o.projection.size.x, o.projection.size.y, glm::vec2(0.7f, 0.001f));
    };
    const auto mesh = [](OutputRenderer::Options& o) {
        WarpShape shape = o.projection.warp.shape();
        shape.mesh.points = {9, 9};
        for (int i = 0; i < 81; ++i) shape.mesh.offsets.push_back({i % 9 % 2, i / 9 % 2});
        o.projection.warp = valueOf(Warp::of(shape));
    };
    return {{"ours", nothing},
            {"with dither", dither},
            {"with gamma 2.2", gamma},
            {"with white balance", tint},
            {"with a LUT of 33", table},
            {"with a blend map", blend},
            {"with a mesh of 9 x 9", mesh},
            {"with all of these", [=](OutputRenderer::Options& o) {
                 for (const auto& set : std::initializer_list<std::function<void(OutputRenderer::Options&)>>{dither, gamma, tint,
                                                                                                             table, blend, mesh})
                     set(o);
             }}};
}

std::unique_ptr<OutputRenderer> rendererOf(const Settings& settings, const PatternSource& source, const Variant& variant) {
    const glm::ivec2 size(settings.width, settings.height);
    OutputRenderer::Options options{
        .projection = {size, Warp::straight(size)}, .samples = settings.samples, .shaders = sourceFolder() + "/assets/shaders"};
    options.projection.light.dither = false;
    variant.set(options);
    return valueOf(OutputRenderer::create(options, PictureSources::numbered({source})));
}

}  // namespace fantascope::render
