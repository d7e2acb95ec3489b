// Measures what our frame costs compared with a minimal program, and how well outputs stay in step.
//
// `cost`: the floor is a plain instanced draw of the same shapes to the same windows: one vertex
// buffer, a matrix and a colour per instance rewritten every frame, the same samples per pixel,
// resolved by glBlitFramebuffer directly into the display's framebuffer; no shading, no clipping at
// the warp's edge, no layers. Both alternate frame by frame in the same run, so that disturbances
// of the machine affect both.
//
// `threads`: compares, in real time, one thread that draws all outputs, as the program does, with
// one thread per output, and with drawing threads for one thread that presents.
//
// `show`: the program's frame loop in real time, beside a latency probe, an empty thread of the
// same rate and rank.

#include "app/live/frame_loop.h"
#include "app/parts/part.h"

#include "core/file.h"
#include "outputs.h"
#include "people.h"
#include "source_folder.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>

namespace fantascope::render {
namespace {

void playShow(const Settings& settings) {
    SteadyClock clock;
    app::setThreadRank(app::Rank::Render);
    std::string text = "fantascope: site\nversion: 1\noutputs:\n";
    for (int i = 0; i < settings.outputs; ++i)
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
    for (int i = 0; i < settings.failing; ++i)
        site.outputs[site.outputs.size() - 1 - static_cast<std::size_t>(i)].projection.size = {1 << 20, 1};
    const PictureSource source = settings.people > 0 ? PictureSource(swayingPeople({settings.people}))
                                                     : PictureSource(swayingCrystals({settings.crystals}));
    show::InputLog inputs(cues);
    app::FrameLoop loop(site, inputs, PictureSources::numbered({source}), sourceFolder() + "/assets", devices, clock);
    must(loop.prepare());
    const Time start = loop.refreshFrom(clock.now() + std::chrono::milliseconds(200)),
               end = start + fromSeconds(settings.seconds);
    loop.begin(show::ShowClock(start));
    loop.makeRenderersAside();
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
    for (const DeviceStatus& status : loop.withFaults(devices.statuses()))
        if (status.state == DeviceState::Faulted) fmt::print("{}: {}\n", status.name, status.detail);
    fmt::print("{} outputs of {} x {} at {} Hz, {} each, {}, {} s\n", settings.outputs, settings.width, settings.height,
               settings.rate, shown, settings.driver, settings.seconds);
    for (const char* key : {"frames_by_output", "late_frames_by_cause", "yardstick", "frame_ms", "swap_skew_ms"})
        fmt::print("{}: {}\n", key, json[key].dump());
}

int runBench(int argc, char** argv) {
    CLI::App program("Measures outputs against a plain draw, and how well they stay in step");
    Settings settings;
    program.require_subcommand(1);
    program.add_option("--outputs", settings.outputs)->capture_default_str();
    program.add_option("--width", settings.width)->capture_default_str();
    program.add_option("--height", settings.height)->capture_default_str();
    program.add_option("--crystals", settings.crystals, "Number of crystals, of 60 triangles each")->capture_default_str();
    program.add_option("--samples", settings.samples, "Per pixel")->capture_default_str();
    CLI::App* const cost = program.add_subcommand("cost", "Our frame compared with a plain instanced draw");
    cost->add_option("--driver", settings.driver, "headless, or glfw on an X server")->capture_default_str();
    cost->add_option("--frames", settings.frames)->capture_default_str();
    CLI::App* const threads =
        program.add_subcommand("threads", "One thread compared with one thread per output, in real time, headless");
    threads->add_option("--seconds", settings.seconds)->capture_default_str();
    threads->add_option("--rate", settings.rate, "Hz")->capture_default_str();
    CLI::App* const show = program.add_subcommand("show", "The frame loop in real time");
    show->add_option("--driver", settings.driver, "headless, or glfw on an X server")->capture_default_str();
    show->add_option("--seconds", settings.seconds)->capture_default_str();
    show->add_option("--rate", settings.rate, "Hz")->capture_default_str();
    show->add_option("--failing", settings.failing, "Outputs of these that can never be drawn: OpenGL has too few pixels")
        ->capture_default_str();
    show->add_option("--people", settings.people, "Shadows of so many people, of 5,000 triangles each, instead of crystals");
    CLI11_PARSE(program, argc, argv);
    if (show->parsed()) playShow(settings);
    if (cost->parsed()) compareCost(settings);
    if (threads->parsed()) compareThreads(settings);
    return 0;
}

}  // namespace
}  // namespace fantascope::render

int main(int argc, char** argv) { return fantascope::render::runBench(argc, argv); }
