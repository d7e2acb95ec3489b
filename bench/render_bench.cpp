// Measures how long a frame takes, in software OpenGL or on whatever GPU EGL offers: a pattern with
// as many triangles as the default show's on every output, or three times as many. Compare with the
// yardstick of the same run, since machines differ and may be shared.

#include "drivers/display/headless.h"

#include "render/output_renderer.h"

#include "core/check.h"
#include "core/random.h"
#include "crystals.h"
#include "people.h"
#include "source_folder.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <memory>
#include <vector>

namespace fantascope::render {
namespace {

constexpr glm::ivec2 kSize{640, 360};
constexpr int kSamples = 4;

constexpr Crystals kDefaultShow{110}, kHeavyShow{330}, kThreeThousand{3000, 10, 11, 0.03};

// A projector that neither dithers nor colours.
const ProjectorLight kPlain = [] {
    ProjectorLight light;
    light.dither = false;
    return light;
}();

struct Output {
    std::unique_ptr<DisplaySink> sink;
    std::unique_ptr<OutputRenderer> renderer;
};

// One frame on `outputs` displays, drawn one after the other and presented together.
void drawFrame(
    benchmark::State& state, int outputs, int layers, const std::vector<PictureSource>& sources, glm::ivec2 size = kSize,
    const std::function<void()>& before = [] {}, const ProjectorLight& light = kPlain) {
    ManualClock clock;
    std::vector<Output> all;
    for (int i = 0; i < outputs; ++i) {
        Output output;
        const ConfigNode driver = valueOf(ConfigNode::parse("driver: headless", "bench"));
        output.sink = valueOf(valueOf(drivers::HeadlessDisplay::fromConfig(driver, {"output", size, 30})).open({clock}));
        FANTASCOPE_CHECK(output.sink->makeCurrent().has_value(), "a new display is there");
        const WarpShape keystone{.corners = {{{40, 20}, {610, 5}, {630, 350}, {10, 340}}}};
        OutputRenderer::Options options;
        options.projection = {size, Warp::of(keystone.scaled(glm::dvec2(size) / glm::dvec2(kSize))).value(), {}, light};
        options.samples = kSamples;
        options.shaders = sourceFolder() + "/assets/shaders";
        output.renderer = valueOf(OutputRenderer::create(options, sources));
        all.push_back(std::move(output));
    }
    show::OutputState look;
    for (int layer = 0; layer < layers; ++layer) look.layers.push_back({static_cast<std::uint32_t>(layer), 0.5f});
    const auto frame = [&] {
        clock.advance(tickTime(1, 30));
        before();
        for (Output& output : all) {
            FANTASCOPE_CHECK(output.sink->makeCurrent().has_value(), "a headless display is never lost");
            output.renderer->draw(look, {}, clock.now(), output.sink->framebuffer());
        }
        for (Output& output : all) FANTASCOPE_CHECK(output.sink->finish().has_value(), "a headless display is never lost");
        for (Output& output : all)
            FANTASCOPE_CHECK(output.sink->presentWith(clock.now()).has_value(), "a headless display is never lost");
    };
    frame();  // OpenGL compiles shaders at their first use
    for (auto _ : state) frame();
    // OpenGL objects are destroyed while their context is current.
    for (Output& output : all) {
        FANTASCOPE_CHECK(output.sink->makeCurrent().has_value(), "a headless display is never lost");
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

// The shadows of `people` people, by `points` points of light.
void drawShadow(benchmark::State& state) {
    const auto samples = static_cast<int>(state.range(1));
    drawFrame(state, 1, 1, {swayingPeople({static_cast<int>(state.range(0)), samples > 1 ? 0.1 : 0, samples})});
}

// A still picture, and one that changes every frame like a video's or a camera's. `rows`: its
// height.
RgbaImage noise(int rows) {
    RgbaImage picture(rows * 16 / 9, rows);
    Rng rng(5);
    for (Rgba8& pixel : picture.pixels()) pixel = {static_cast<std::uint8_t>(rng.uniform(0, 255)), 100, 200, 255};
    return picture;
}
void drawImage(benchmark::State& state) {
    const int rows = static_cast<int>(state.range(0));
    drawFrame(state, 1, 1, {ImageSource{std::make_shared<const RgbaImage>(noise(rows))}});
}
void drawChangingPicture(benchmark::State& state) {
    const auto picture = std::make_shared<const RgbaImage>(noise(static_cast<int>(state.range(0))));
    const auto feed = std::make_shared<PictureFeed>(glm::ivec2(picture->width(), picture->height()));
    drawFrame(state, 1, 1, {CameraSource{feed}}, kSize, [&] { feed->publish(picture); });
}

// Decodes and converts one frame of the video named by FANTASCOPE_VIDEO.
void decodeVideo(benchmark::State& state) {
    const char* const file = std::getenv("FANTASCOPE_VIDEO");
    if (file == nullptr) return state.SkipWithError("name a video in FANTASCOPE_VIDEO");
    const auto content = valueOf(VideoDecoder::examine(file));
    const auto decoder = valueOf(VideoDecoder::open(content));
    RgbaImage picture(content->size.x, content->size.y);
    for (auto _ : state) {
        if (!decoder->next()) {
            decoder->seek(0);
            decoder->next();
        }
        if (state.range(0) != 0) decoder->picture(picture);
    }
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
BENCHMARK(drawShadow)->ArgNames({"people", "points"})->ArgsProduct({{1, 6, 12}, {1, 16}})->Apply(settings);
BENCHMARK(drawImage)->ArgName("rows")->Arg(360)->Arg(720)->Arg(1080)->Arg(2160)->Apply(settings);
BENCHMARK(drawChangingPicture)->ArgName("rows")->Arg(360)->Arg(720)->Arg(1080)->Arg(2160)->Apply(settings);
BENCHMARK(decodeVideo)->ArgName("converted")->Arg(0)->Arg(1)->Apply(settings);

// Yardstick: the minimum work for one multisampled picture on one core: every sample's colour and
// depth is cleared, then averaged.
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
