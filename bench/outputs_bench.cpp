// What our frame costs beside what a user would write for it, and how outputs keep together.
//
// `cost`: the floor is a plain instanced draw of the same shapes to the same windows: one vertex
// buffer, a matrix and a colour an instance written anew every frame, the same samples a pixel,
// resolved by glBlitFramebuffer straight into what is shown; no light, no warp's edge, no layers.
// Both take turns in the same run, frame by frame, so that what the machine does meanwhile meets
// both.
//
// `threads`: one thread that draws all outputs, as the program does, against a thread an output,
// and against threads that draw for one that shows, in real time.
//
// `show`: the program's frame loop in real time, beside an empty thread of the same rate and rank.

#include "app/live/frame_loop.h"
#include "app/live/part.h"
#include "drivers/registry.h"

#include "render/gpu/shader_program.h"
#include "render/output_renderer.h"

#include "core/check.h"
#include "core/clock.h"
#include "core/file.h"
#include "crystals.h"
#include "people.h"
#include "source_folder.h"

#include <CLI/CLI.hpp>
#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <barrier>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace fantascope::render {
namespace {

struct Settings {
    std::string driver = "headless";
    int outputs = 3, width = 640, height = 360, crystals = 333, people = 0, samples = 4, frames = 150;
    double rate = 30, seconds = 30;  // Hz; of each run
    bool broken = false, aside = true;
};

void must(const Result<void>& result) { FANTASCOPE_CHECK(result.has_value(), result.error().message()); }

double processorSeconds() {
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    const auto of = [](const timeval& time) {
        return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
    };
    return of(usage.ru_utime) + of(usage.ru_stime);
}

const std::filesystem::path kFolder = sourceFolder() + "/bench";

// The plain draw on one output. Its context is current in every call.
class Floor {
public:
    Floor(const PatternSource& source, glm::ivec2 size, int samples)
        : source_(source), size_(size), poses_(source.pattern->instances.size()) {
        const TriangleMesh& mesh = source.pattern->shapes[0].mesh;
        indices_ = static_cast<GLsizei>(3 * mesh.triangles.size());
        instances_.resize(poses_.size());
        const auto bytes = [](const auto& all) { return static_cast<GLsizeiptr>(all.size() * sizeof(all[0])); };
        std::array<GLuint, 3> buffers{};
        glCreateBuffers(3, buffers.data());
        glNamedBufferStorage(buffers[0], bytes(mesh.vertices), mesh.vertices.data(), 0);
        glNamedBufferStorage(buffers[1], bytes(mesh.triangles), mesh.triangles.data(), 0);
        perInstance_ = buffers[2];
        glNamedBufferData(perInstance_, bytes(instances_), nullptr, GL_STREAM_DRAW);
        glCreateVertexArrays(1, &array_);
        glVertexArrayElementBuffer(array_, buffers[1]);
        glVertexArrayVertexBuffer(array_, 0, buffers[0], 0, sizeof(glm::vec3));
        glVertexArrayVertexBuffer(array_, 1, perInstance_, 0, sizeof(Instance));
        glVertexArrayBindingDivisor(array_, 1, 1);
        const auto attribute = [&](GLuint binding, GLuint location, GLint components, std::size_t offset) {
            glEnableVertexArrayAttrib(array_, location);
            glVertexArrayAttribFormat(array_, location, components, GL_FLOAT, GL_FALSE, static_cast<GLuint>(offset));
            glVertexArrayAttribBinding(array_, location, binding);
        };
        attribute(0, 0, 3, 0);
        for (GLuint column = 0; column < 4; ++column) attribute(1, 1 + column, 4, column * sizeof(glm::vec4));
        attribute(1, 5, 3, offsetof(Instance, colour));

        std::array<GLuint, 2> planes{};
        glCreateRenderbuffers(2, planes.data());
        glNamedRenderbufferStorageMultisample(planes[0], samples, GL_SRGB8_ALPHA8, size.x, size.y);
        glNamedRenderbufferStorageMultisample(planes[1], samples, GL_DEPTH_COMPONENT24, size.x, size.y);
        glCreateFramebuffers(1, &framebuffer_);
        glNamedFramebufferRenderbuffer(framebuffer_, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, planes[0]);
        glNamedFramebufferRenderbuffer(framebuffer_, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, planes[1]);
    }

    // Draws it and resolves it into `shown`.
    void draw(Time time, unsigned shown) {
        if (source_.motion) source_.motion->posesAt(time, {}, poses_);
        const double aspect = source_.pattern->aspect(), slice = 1.0 / static_cast<double>(poses_.size());
        for (std::size_t i = 0; i < poses_.size(); ++i) {
            const glm::dmat3 turn = pattern::canvasFromShape({poses_[i].centre, 1, poses_[i].rotation});
            const glm::dvec3 scale(2 / aspect, -2, -slice);
            glm::mat4& matrix = instances_[i].clipFromShape;
            for (int axis = 0; axis < 3; ++axis) matrix[axis] = glm::vec4(scale * turn[axis] * poses_[i].size, 0);
            matrix[3] = glm::vec4(2 * poses_[i].centre.x / aspect - 1, 1 - 2 * poses_[i].centre.y,
                                  1 - (2 * static_cast<double>(i) + 1) * slice, 1);
            instances_[i].colour = source_.pattern->instances[i].colour;
        }
        glNamedBufferSubData(perInstance_, 0, static_cast<GLsizeiptr>(instances_.size() * sizeof(Instance)), instances_.data());

        glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer_);
        glViewport(0, 0, size_.x, size_.y);
        glEnable(GL_FRAMEBUFFER_SRGB);
        glEnable(GL_DEPTH_TEST);
        glDepthFunc(GL_LESS);
        glEnable(GL_CULL_FACE);
        glFrontFace(GL_CCW);
        glClearColor(0, 0, 0, 1);
        glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
        glUseProgram(program_.name());
        glBindVertexArray(array_);
        glDrawElementsInstanced(GL_TRIANGLES, indices_, GL_UNSIGNED_INT, nullptr, static_cast<GLsizei>(instances_.size()));
        glDisable(GL_FRAMEBUFFER_SRGB);
        glBlitNamedFramebuffer(framebuffer_, shown, 0, 0, size_.x, size_.y, 0, 0, size_.x, size_.y, GL_COLOR_BUFFER_BIT,
                               GL_NEAREST);
    }

private:
    struct Instance {
        glm::mat4 clipFromShape{1};
        glm::vec3 colour{1};
    };
    PatternSource source_;
    glm::ivec2 size_;
    gpu::Program program_ = valueOf(gpu::loadProgram(kFolder / "floor.vert", kFolder / "floor.frag"));
    std::vector<pattern::InstancePose> poses_;
    std::vector<Instance> instances_;
    GLuint perInstance_ = 0, array_ = 0, framebuffer_ = 0;
    GLsizei indices_ = 0;
};

std::unique_ptr<DisplaySink> opened(const Settings& settings, int number, Clock& clock) {
    const ConfigNode options = valueOf(ConfigNode::parse("driver: " + settings.driver, "bench"));
    const std::string name = fmt::format("output {}", number);
    auto sink = valueOf(drivers::openDisplay(options, {name, {settings.width, settings.height}, settings.rate}, {clock}));
    FANTASCOPE_CHECK(sink->poll(), sink->status().detail);
    must(sink->makeCurrent());
    return sink;
}

// What a frame may have besides.
struct Variant {
    std::string name;
    std::function<void(OutputRenderer::Options&)> set;
};
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
    return valueOf(OutputRenderer::create(options, std::vector<PictureSource>{source}));
}

const show::OutputState kLook{{{0, 1.0f}}};

// The least of the frames' times tells what the work takes, the median what it takes on this
// machine now.
struct Cost {
    std::vector<double> real, processor;  // ms a frame
    static double median(std::vector<double> of) {
        std::nth_element(of.begin(), of.begin() + static_cast<std::ptrdiff_t>(of.size() / 2), of.end());
        return of[of.size() / 2];
    }
};

void compareCost(const Settings& settings) {
    app::setThreadRank(app::Rank::Render);  // as the program has it
    ManualClock clock;
    const SteadyClock watch;
    const std::vector<Variant> all = variants();
    const PatternSource source = swayingCrystals({settings.crystals});
    struct Output {
        std::unique_ptr<DisplaySink> sink;
        std::unique_ptr<Floor> floor;
        std::vector<std::unique_ptr<OutputRenderer>> ours;
    };
    std::vector<Output> outputs;
    for (int i = 0; i < settings.outputs; ++i) {
        Output& output = outputs.emplace_back();
        output.sink = opened(settings, i, clock);
        output.floor = std::make_unique<Floor>(source, output.sink->size(), settings.samples);
        for (const Variant& variant : all) output.ours.push_back(rendererOf(settings, source, variant));
    }
    const bool window = settings.driver != "headless";
    // Way 0 is the floor.
    const auto frame = [&](std::size_t way, Time time) {
        for (Output& output : outputs) {
            must(output.sink->makeCurrent());
            if (way == 0)
                output.floor->draw(time, window ? 0 : output.sink->framebuffer());
            else
                output.ours[way - 1]->draw(kLook, {}, time, output.sink->framebuffer());
        }
        for (Output& output : outputs) {
            must(output.sink->makeCurrent());
            // What is in a window's back buffer already needs no copy from our framebuffer.
            if (way == 0)
                glFinish();
            else
                must(output.sink->finish());
        }
        for (Output& output : outputs) FANTASCOPE_CHECK(output.sink->presentWith(clock.now()).has_value(), "nobody closes it");
    };
    std::vector<Cost> costs(all.size() + 1);
    constexpr int kWarm = 5;
    for (int number = -kWarm; number < settings.frames; ++number) {
        const Time time = tickTime(number + kWarm, settings.rate);
        for (std::size_t way = 0; way < costs.size(); ++way) {
            const double processor = processorSeconds();
            const Time began = watch.now();
            frame(way, time);
            if (number < 0) continue;
            costs[way].real.push_back(1e3 * seconds(watch.now() - began));
            costs[way].processor.push_back(1e3 * (processorSeconds() - processor));
        }
    }
    const auto per = static_cast<double>(settings.outputs);
    const Cost& floor = costs[0];
    fmt::print(
        "{} outputs of {} x {}, {} triangles each, {} samples a pixel, {}, {} frames of each kind; ms an output's frame, "
        "median\n",
        settings.outputs, settings.width, settings.height, settings.crystals * 60, settings.samples, settings.driver,
        settings.frames);
    fmt::print("{:<22}{:>10}{:>10}{:>10}{:>10}\n", "", "real", "CPU", "x floor", "x CPU");
    for (std::size_t way = 0; way < costs.size(); ++way)
        fmt::print("{:<22}{:>10.2f}{:>10.2f}{:>10.2f}{:>10.2f}\n", way == 0 ? "floor" : all[way - 1].name,
                   Cost::median(costs[way].real) / per, Cost::median(costs[way].processor) / per,
                   Cost::median(costs[way].real) / Cost::median(floor.real),
                   Cost::median(costs[way].processor) / Cost::median(floor.processor));
    for (Output& output : outputs) {
        must(output.sink->makeCurrent());
        output.ours.clear();
    }
}

// What became of each refresh, by the clock that all outputs share.
struct Pace {
    std::vector<std::vector<std::int64_t>> shown;  // refreshes by output
    double processor = 0;                          // seconds
    std::vector<double> workMs;                    // of a frame, from its beginning to its completion
};

void tell(const std::string& name, const Settings& settings, Pace pace) {
    std::map<std::int64_t, std::size_t> outputsAt;
    std::int64_t first = 0, last = INT64_MAX, frames = 0;
    for (const auto& refreshes : pace.shown) {
        first = std::max(first, refreshes.front());
        last = std::min(last, refreshes.back());
    }
    for (const auto& refreshes : pace.shown)
        for (const std::int64_t refresh : refreshes)
            if (refresh >= first && refresh <= last) ++outputsAt[refresh], ++frames;
    const std::int64_t refreshes = last - first + 1;
    std::int64_t torn = 0;
    for (const auto& [refresh, count] : outputsAt) torn += count != pace.shown.size();
    std::sort(pace.workMs.begin(), pace.workMs.end());
    const auto quantile = [&](double p) {
        return pace.workMs[static_cast<std::size_t>(p * static_cast<double>(pace.workMs.size() - 1))];
    };
    fmt::print("{:<20}{:>9}{:>9}{:>9}{:>10.1f}{:>10.1f}{:>12.1f}\n", name, refreshes, refreshes * settings.outputs - frames, torn,
               quantile(0.5), quantile(0.99), 1e3 * pace.processor / static_cast<double>(refreshes));
}

Pace oneThread(const Settings& settings, const PatternSource& source) {
    SteadyClock clock;
    std::vector<std::unique_ptr<DisplaySink>> sinks;
    std::vector<std::unique_ptr<OutputRenderer>> renderers;
    Pace pace;
    for (int i = 0; i < settings.outputs; ++i) {
        sinks.push_back(opened(settings, i, clock));
        renderers.push_back(rendererOf(settings, source, variants()[0]));
        must(renderers.back()->warmUp(sinks.back()->framebuffer()));
        pace.shown.emplace_back();
    }
    const double processor = processorSeconds();
    for (const Time end = clock.now() + fromSeconds(settings.seconds); clock.now() < end;) {
        const Time began = clock.now(), due = sinks[0]->refreshTime(sinks[0]->nextRefresh());
        for (std::size_t i = 0; i < sinks.size(); ++i) {
            must(sinks[i]->makeCurrent());
            renderers[i]->draw(kLook, {}, due, sinks[i]->framebuffer());
        }
        for (const auto& sink : sinks) must(sink->finish());
        pace.workMs.push_back(1e3 * seconds(clock.now() - began));
        const Shown leading = valueOf(sinks[0]->present());
        pace.shown[0].push_back(leading.refresh);
        for (std::size_t i = 1; i < sinks.size(); ++i)
            pace.shown[i].push_back(valueOf(sinks[i]->presentWith(leading.at)).refresh);
    }
    pace.processor = processorSeconds() - processor;
    for (std::size_t i = 0; i < sinks.size(); ++i) {
        must(sinks[i]->makeCurrent());
        renderers[i].reset();
    }
    return pace;
}

Pace threadAnOutput(const Settings& settings, const PatternSource& source) {
    SteadyClock clock;
    Pace pace;
    pace.shown.resize(static_cast<std::size_t>(settings.outputs));
    std::vector<std::vector<double>> work(pace.shown.size());
    std::atomic<int> ready = 0;
    std::atomic<bool> begin = false;
    double processor = 0;
    {
        std::vector<std::jthread> threads;
        for (std::size_t i = 0; i < pace.shown.size(); ++i)
            threads.emplace_back([&, i] {
                const auto sink = opened(settings, static_cast<int>(i), clock);
                auto renderer = rendererOf(settings, source, variants()[0]);
                must(renderer->warmUp(sink->framebuffer()));
                ++ready;
                begin.wait(false);
                for (const Time end = clock.now() + fromSeconds(settings.seconds); clock.now() < end;) {
                    const Time began = clock.now();
                    must(sink->makeCurrent());
                    renderer->draw(kLook, {}, sink->refreshTime(sink->nextRefresh()), sink->framebuffer());
                    must(sink->finish());
                    work[i].push_back(1e3 * seconds(clock.now() - began));
                    pace.shown[i].push_back(valueOf(sink->present()).refresh);
                }
                renderer.reset();
            });
        while (ready < settings.outputs) std::this_thread::yield();
        processor = processorSeconds();
        begin = true;
        begin.notify_all();
    }
    pace.processor = processorSeconds() - processor;
    for (const auto& one : work) pace.workMs.insert(pace.workMs.end(), one.begin(), one.end());
    return pace;
}

// Drawn on a thread an output and shown by one: the thread that shows waits until all pictures are
// complete.
Pace drawnOnThreads(const Settings& settings, const PatternSource& source) {
    SteadyClock clock;
    Pace pace;
    std::vector<std::unique_ptr<DisplaySink>> sinks;
    std::vector<std::unique_ptr<OutputRenderer>> renderers;
    const auto letGo = [] { eglMakeCurrent(eglGetCurrentDisplay(), EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT); };
    for (int i = 0; i < settings.outputs; ++i) {
        sinks.push_back(opened(settings, i, clock));
        renderers.push_back(rendererOf(settings, source, variants()[0]));
        must(renderers.back()->warmUp(sinks.back()->framebuffer()));
        letGo();
        pace.shown.emplace_back();
    }
    std::barrier frame(settings.outputs);
    bool ended = false;
    Time due{};
    const auto draw = [&](std::size_t i) {
        must(sinks[i]->makeCurrent());
        renderers[i]->draw(kLook, {}, due, sinks[i]->framebuffer());
        must(sinks[i]->finish());
        letGo();
    };
    const double processor = processorSeconds();
    {
        std::vector<std::jthread> threads;
        for (std::size_t i = 1; i < sinks.size(); ++i)
            threads.emplace_back([&, i] {
                for (frame.arrive_and_wait(); !ended; frame.arrive_and_wait()) {
                    draw(i);
                    frame.arrive_and_wait();
                }
            });
        for (const Time end = clock.now() + fromSeconds(settings.seconds); clock.now() < end;) {
            const Time began = clock.now();
            due = sinks[0]->refreshTime(sinks[0]->nextRefresh());
            frame.arrive_and_wait();
            draw(0);
            frame.arrive_and_wait();
            pace.workMs.push_back(1e3 * seconds(clock.now() - began));
            const Shown leading = valueOf(sinks[0]->present());
            pace.shown[0].push_back(leading.refresh);
            for (std::size_t i = 1; i < sinks.size(); ++i)
                pace.shown[i].push_back(valueOf(sinks[i]->presentWith(leading.at)).refresh);
            letGo();
        }
        ended = true;
        frame.arrive_and_wait();
    }
    pace.processor = processorSeconds() - processor;
    for (std::size_t i = 0; i < sinks.size(); ++i) {
        must(sinks[i]->makeCurrent());
        renderers[i].reset();
    }
    return pace;
}

void compareThreads(const Settings& settings) {
    app::setThreadRank(app::Rank::Render);  // as the program has it
    const PatternSource source = swayingCrystals({settings.crystals});
    fmt::print(
        "{} outputs of {} x {} at {} Hz, {} triangles each, {} s of each kind; torn: refreshes that some outputs met and others "
        "did not;\n"
        "work: from a frame's beginning to its completion, of all outputs or of one\n",
        settings.outputs, settings.width, settings.height, settings.rate, settings.crystals * 60, settings.seconds);
    fmt::print("{:<20}{:>9}{:>9}{:>9}{:>10}{:>10}{:>12}\n", "", "refreshes", "late", "torn", "work p50", "p99 ms", "CPU ms/ref.");
    for (int run = 0; run < 2; ++run) {
        tell("one thread", settings, oneThread(settings, source));
        tell("a thread an output", settings, threadAnOutput(settings, source));
        tell("drawn on threads", settings, drawnOnThreads(settings, source));
    }
}

void playShow(const Settings& settings) {
    SteadyClock clock;
    app::setThreadRank(app::Rank::Render);
    std::string text = "fantascope: site\nversion: 1\noutputs:\n";
    for (int i = 0; i < settings.outputs + (settings.broken ? 1 : 0); ++i)
        text += fmt::format("  - {{name: output-{}, display: {{driver: {}}}, size: [{}, {}], refresh_rate: {}}}\n", i,
                            settings.driver, settings.width, settings.height, settings.rate);
    const std::filesystem::path file = std::filesystem::temp_directory_path() / fmt::format("outputs-bench-{}.yaml", ::getpid());
    must(writeFile(file, text));
    show::Site site = valueOf(show::readSite(file));
    std::filesystem::remove(file);
    show::CueList cues;
    cues.dark.outputs.resize(site.outputs.size());
    show::Look look = cues.dark;
    for (show::OutputState& output : look.outputs) output.layers = {{0, 1.0f}};
    cues.cues.push_back({look, Time{}, std::nullopt});

    app::Devices devices = valueOf(app::openDevices(site, app::Backends::AsDeclared, {clock}));
    if (settings.broken) site.outputs[0].projection.size = {100'000, 100'000};  // more than any OpenGL draws
    const PictureSource source = settings.people > 0 ? PictureSource(swayingPeople({settings.people}))
                                                     : PictureSource(swayingCrystals({settings.crystals}));
    show::InputLog inputs(cues);
    app::FrameLoop loop(site, inputs, {source}, sourceFolder() + "/assets", devices, clock);
    must(loop.prepare());
    if (settings.aside) loop.makeRenderersAside();
    const Time start = loop.refreshFrom(clock.now() + std::chrono::milliseconds(200)),
               end = start + fromSeconds(settings.seconds);
    loop.begin(start);
    inputs.submit({Time{}, show::Input::Kind::Go});
    app::RunReport report;
    {
        std::vector<app::Part> parts;
        parts.push_back({"yardstick", settings.rate, start,
                         [&, last = std::int64_t{-1}](Time moment) mutable {
                             const std::int64_t tick = tickAt(moment - start, settings.rate);
                             report.yardstickLate += tick - last - 1;
                             ++report.yardstickTicks;
                             last = tick;
                         },
                         app::Rank::Render});
        const app::PartThreads threads(clock, std::move(parts));
        clock.sleepUntil(start);
        while (loop.nextDue() <= end) loop.step();
        clock.sleepUntil(end);
    }
    loop.finish(end);
    report.length = end - start;
    report.outputs = loop.outputs();
    report.swapSkew = loop.swapSkew();
    const app::Report json = app::jsonOf(report);
    const std::string shown = settings.people > 0 ? fmt::format("shadows of {} people", settings.people)
                                                  : fmt::format("{} triangles", settings.crystals * 60);
    fmt::print("{} outputs of {} x {} at {} Hz, {} each, {}, {} s\n", settings.outputs, settings.width, settings.height,
               settings.rate, shown, settings.driver, settings.seconds);
    for (const char* key : {"frames_by_output", "late_frames_by_cause", "yardstick", "frame_ms", "swap_skew_ms"})
        fmt::print("{}: {}\n", key, json[key].dump());
    for (const DeviceStatus& display : loop.withFaults(devices.statuses()))
        if (!display.detail.empty()) fmt::print("{}: {}\n", display.name, display.detail);
}

int runBench(int argc, char** argv) {
    CLI::App program("Outputs beside a plain draw, and beside each other");
    Settings settings;
    program.require_subcommand(1);
    program.add_option("--outputs", settings.outputs)->capture_default_str();
    program.add_option("--width", settings.width)->capture_default_str();
    program.add_option("--height", settings.height)->capture_default_str();
    program.add_option("--crystals", settings.crystals, "of 60 triangles")->capture_default_str();
    program.add_option("--samples", settings.samples, "a pixel")->capture_default_str();
    CLI::App* const cost = program.add_subcommand("cost", "our frame beside a plain instanced draw");
    cost->add_option("--driver", settings.driver, "headless, or glfw on an X server")->capture_default_str();
    cost->add_option("--frames", settings.frames)->capture_default_str();
    CLI::App* const threads = program.add_subcommand("threads", "one thread beside a thread an output, in real time, headless");
    threads->add_option("--seconds", settings.seconds)->capture_default_str();
    threads->add_option("--rate", settings.rate, "Hz")->capture_default_str();
    CLI::App* const show = program.add_subcommand("show", "the frame loop in real time");
    show->add_option("--driver", settings.driver, "headless, or glfw on an X server")->capture_default_str();
    show->add_option("--seconds", settings.seconds)->capture_default_str();
    show->add_option("--rate", settings.rate, "Hz")->capture_default_str();
    show->add_flag("--broken", settings.broken, "one output more, whose renderer can never be made");
    show->add_flag("!--not-aside", settings.aside, "missing renderers are made on the render thread");
    show->add_option("--people", settings.people, "shadows of so many, of 5,000 triangles each, instead of crystals");
    CLI11_PARSE(program, argc, argv);
    if (show->parsed()) playShow(settings);
    if (cost->parsed()) compareCost(settings);
    if (threads->parsed()) compareThreads(settings);
    return 0;
}

}  // namespace
}  // namespace fantascope::render

int main(int argc, char** argv) { return fantascope::render::runBench(argc, argv); }
