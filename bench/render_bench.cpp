// How long a frame takes: a pattern of as many triangles as the default show's on every output, or of three times as many, in software
// OpenGL or on whatever GPU EGL offers. Compare with the yardstick of the same run, since machines and their neighbours differ.

#include "drivers/display/headless.h"

#include "render/output_renderer.h"

#include "core/check.h"
#include "core/random.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <vector>

namespace fantascope::render {
namespace {

constexpr glm::ivec2 kSize{640, 360};
constexpr int kSamples = 4;

// A closed crystal of 2 * segments * (rings - 1) facets.
TriangleMesh crystal(std::uint32_t segments, std::uint32_t rings) {
    TriangleMesh mesh;
    mesh.vertices.push_back({0, 1, 0});
    for (std::uint32_t ring = 1; ring < rings; ++ring)
        for (std::uint32_t segment = 0; segment < segments; ++segment) {
            const double polar = std::numbers::pi * ring / rings, around = 2 * std::numbers::pi * segment / segments;
            mesh.vertices.push_back({std::sin(polar) * std::cos(around), std::cos(polar), std::sin(polar) * std::sin(around)});
        }
    mesh.vertices.push_back({0, -1, 0});
    const auto bottom = static_cast<std::uint32_t>(mesh.vertices.size() - 1);
    for (std::uint32_t segment = 0; segment < segments; ++segment) {
        const std::uint32_t next = (segment + 1) % segments;
        mesh.triangles.push_back({0, 1 + next, 1 + segment});
        for (std::uint32_t ring = 0; ring + 2 < rings; ++ring) {
            const std::uint32_t upper = 1 + ring * segments, lower = upper + segments;
            mesh.triangles.push_back({upper + segment, upper + next, lower + segment});
            mesh.triangles.push_back({upper + next, lower + next, lower + segment});
        }
        mesh.triangles.push_back({bottom, bottom - segments + segment, bottom - segments + next});
    }
    return mesh;
}

struct Crystals {
    int count;
    std::uint32_t segments = 6, rings = 6;  // of 60 facets
    double largest = 0.06;                  // canvas heights
};
constexpr Crystals kDefaultShow{110}, kHeavyShow{330}, kThreeThousand{3000, 10, 11, 0.03};

PatternSource swayingCrystals(const Crystals& crystals) {
    pattern::ShapePattern pattern;
    pattern.width = kSize.x;
    pattern.height = kSize.y;
    pattern.shapes.push_back({"crystal", crystal(crystals.segments, crystals.rings)});
    Rng rng(1);
    for (std::uint32_t id = 0; id < static_cast<std::uint32_t>(crystals.count); ++id) {
        pattern::ShapeInstance instance;
        instance.id = id;
        instance.centre = {rng.uniform(0, pattern.aspect()), rng.uniform()};
        instance.size = rng.uniform(crystals.largest / 3, crystals.largest);
        instance.rotation = {rng.uniform(0, 3), rng.uniform(0, 3), rng.uniform(0, 3)};
        pattern.instances.push_back(instance);
    }
    const auto shared = std::make_shared<const pattern::ShapePattern>(std::move(pattern));
    return {shared, std::make_shared<const pattern::PatternMotion>(*shared)};
}

struct Output {
    std::unique_ptr<DisplaySink> sink;
    std::unique_ptr<OutputRenderer> renderer;
};

// Ends on a refusal: a bench has nobody to tell.
template <class T>
T valueOf(Result<T> result) {
    FANTASCOPE_CHECK(result.has_value(), result.error().message());
    return std::move(result).value();
}

// One frame on `outputs` displays: drawn one after the other, presented together.
void drawFrame(benchmark::State& state, int outputs, int layers, const std::vector<PictureSource>& sources,
               glm::ivec2 size = kSize) {
    ManualClock clock;
    std::vector<Output> all;
    for (int i = 0; i < outputs; ++i) {
        Output output;
        const ConfigNode options = valueOf(ConfigNode::parse("driver: headless", "bench"));
        output.sink = valueOf(drivers::HeadlessDisplay::open(options, {"output", size, 30}, {clock}));
        FANTASCOPE_CHECK(output.sink->makeCurrent().has_value(), "a new display is there");
        OutputRenderer::Options keystone;
        keystone.size = size;
        keystone.corners = {{{40, 20}, {610, 5}, {630, 350}, {10, 340}}};
        for (glm::dvec2& corner : keystone.corners) corner *= glm::dvec2(size) / glm::dvec2(kSize);
        keystone.samples = kSamples;
        keystone.shaders = FANTASCOPE_SOURCE_DIR "/assets/shaders";
        output.renderer = valueOf(OutputRenderer::create(keystone, sources));
        all.push_back(std::move(output));
    }
    show::OutputState look;
    for (int layer = 0; layer < layers; ++layer) look.layers.push_back({static_cast<std::uint32_t>(layer), 0.5f});
    const auto frame = [&] {
        clock.advance(tickTime(1, 30));
        for (Output& output : all) {
            FANTASCOPE_CHECK(output.sink->makeCurrent().has_value(), "nobody unplugs it");
            output.renderer->draw(look, {}, clock.now(), output.sink->framebuffer());
        }
        for (Output& output : all) FANTASCOPE_CHECK(output.sink->presentWith(clock.now()).has_value(), "nobody unplugs it");
    };
    frame();  // OpenGL compiles its shaders at the first use
    for (auto _ : state) frame();
    // OpenGL objects go while their context is current.
    for (Output& output : all) {
        FANTASCOPE_CHECK(output.sink->makeCurrent().has_value(), "nobody unplugs it");
        output.renderer.reset();
    }
}
void drawPatterns(benchmark::State& state, int outputs, int layers, const Crystals& crystals) {
    drawFrame(state, outputs, layers, {swayingCrystals(crystals), swayingCrystals(crystals)});
}
void drawThreeThousand(benchmark::State& state) { drawFrame(state, 1, 1, {swayingCrystals(kThreeThousand)}, {1280, 720}); }

// The shadow of as many crystals, blurred with a disc of this radius in pixels of the canvas.
void drawFoliage(benchmark::State& state) {
    constexpr double kRows = 331;  // of the canvas, see the corners
    FoliageSource foliage;
    foliage.layers.push_back({swayingCrystals(kDefaultShow), {2 * static_cast<double>(state.range(0)) / kRows, nullptr}});
    drawFrame(state, 1, 1, {foliage});
}
void drawCaustics(benchmark::State& state) {
    drawFrame(state, 1, 1, {CausticsSource{glm::vec3(0.2f), {16.0 / 3, 3}, 1.2, 0.6, 0.02, 1}});
}
void drawMirrorBall(benchmark::State& state) {
    drawFrame(state, 1, 1, {MirrorBallSource{glm::vec3(1), {16.0 / 3, 3}, {0, 0.4, 2.4}, 0.25, 0.02, {3.6, 1.6, 1.2}, 0.04, 40}});
}

void settings(benchmark::internal::Benchmark* bench) {
    bench->Unit(benchmark::kMillisecond)->UseRealTime()->MeasureProcessCPUTime();
}
BENCHMARK_CAPTURE(drawPatterns, one_output, 1, 1, kDefaultShow)->Apply(settings);
BENCHMARK_CAPTURE(drawPatterns, one_output_in_a_crossfade, 1, 2, kDefaultShow)->Apply(settings);
BENCHMARK_CAPTURE(drawPatterns, two_outputs, 2, 1, kDefaultShow)->Apply(settings);
BENCHMARK_CAPTURE(drawPatterns, two_outputs_in_a_crossfade, 2, 2, kDefaultShow)->Apply(settings);
BENCHMARK_CAPTURE(drawPatterns, one_output_heavy, 1, 1, kHeavyShow)->Apply(settings);
BENCHMARK_CAPTURE(drawPatterns, one_output_black, 1, 0, kDefaultShow)->Apply(settings);
BENCHMARK(drawThreeThousand)->Apply(settings);
BENCHMARK(drawFoliage)->ArgName("radius")->Arg(0)->Arg(2)->Arg(5)->Arg(10)->Arg(20)->Arg(40)->Arg(80)->Apply(settings);
BENCHMARK(drawCaustics)->Apply(settings);
BENCHMARK(drawMirrorBall)->Apply(settings);

// The yardstick: what one multisampled picture needs at least, on one core: every sample's colour and depth cleared, then
// averaged.
void yardstick(benchmark::State& state) {
    constexpr std::size_t kPixels = static_cast<std::size_t>(kSize.x) * kSize.y;
    std::vector<std::uint32_t> colour(kPixels * kSamples), depth(kPixels * kSamples), picture(kPixels);
    for (auto _ : state) {
        std::fill(colour.begin(), colour.end(), 0xff000000u);
        std::fill(depth.begin(), depth.end(), 0xffffffu);
        for (std::size_t pixel = 0; pixel < kPixels; ++pixel) {
            std::uint32_t sum = 0;
            for (std::size_t sample = 0; sample < kSamples; ++sample) sum += colour[sample * kPixels + pixel] >> 2 & 0x3f3f3f3fu;
            picture[pixel] = sum;
        }
        benchmark::DoNotOptimize(picture.data());
        benchmark::DoNotOptimize(depth.data());
        benchmark::ClobberMemory();
    }
}
BENCHMARK(yardstick)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace fantascope::render
