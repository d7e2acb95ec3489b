#include "app/rehearse_command.h"

#include "app/data_folder.h"
#include "app/interrupt.h"
#include "app/progress.h"
#include "app/show_run.h"

#include <fmt/format.h>

#include <iostream>

namespace fantascope::app {
namespace {

struct Options {
    std::string show, site, fromCue, record;
    std::string pictures = RunOptions{}.pictures;
    std::optional<double> length;  // seconds
    std::filesystem::path report;
    std::uint64_t seed = 1;
    bool window = false, asFastAsPossible = false, byHand = false;
};

// The line that a person watches while a show runs.
std::string lineOf(const RunStatus& status) {
    std::string line =
        fmt::format("{:6.1f} s  {:5.1f} frames/s  {} late", seconds(status.showTime), status.framesPerSecond, status.lateFrames);
    for (const auto& [output, z] : status.zCamera)
        line += z < 0 ? fmt::format("  z {} -", output) : fmt::format("  z {} {:.3f}", output, z);
    return line;
}

Result<void> runAndReport(const RunOptions& run, const std::filesystem::path& reportFile, const std::string& label) {
    const Interrupt interrupt;
    RunReport report;
    {
        const SteadyClock clock;
        const bool terminal = standardErrorIsTerminal();
        Progress progress(label, clock, std::cerr, terminal);
        report = TRY(runShow(run, interrupt, [&](const RunStatus& status) {
            if (!status.said.empty())
                std::cerr << (terminal ? "\r\x1b[K" : "") << fmt::format("{:6.1f} s  {}", seconds(status.showTime), status.said)
                          << std::endl;
            progress.update(run.length ? std::optional(seconds(status.showTime) / seconds(*run.length)) : std::nullopt,
                            lineOf(status));
        }));
    }
    if (!reportFile.empty()) TRY(writeReport(reportFile, jsonOf(report)));
    std::int64_t frames = 0, late = 0;
    for (const OutputReport& output : report.outputs) {
        frames += output.frames;
        late += output.lateFrames();
    }
    fmt::print("{:.1f} s, {} cues entered, {} frames shown, {} late ({}an idle thread missed {} of {} refreshes)\n",
               seconds(report.length), report.cues.size(), frames, late, late > 0 ? lateFramesByCause(report.outputs) + "; " : "",
               report.yardstickLate, report.yardstickTicks);
    return {};
}

void declareCommon(CLI::App& command, Options& options) {
    command.add_option("--seconds", options.length, "end after this much show time")->check(CLI::Range(0.1, 1e6));
    command.add_option("--from", options.fromCue, "enter this cue at once, by its name");
    command.add_option("--record", options.record,
                       "leave videos, traces and a contact sheet in this folder, or one video in FILE.mp4");
    command.add_option("--pictures", options.pictures, "where the key s leaves a picture of every output")->capture_default_str();
    command.add_option("--report", options.report, "write the run's figures to this JSON file (docs/report.md)");
}

RunOptions commonOf(const Options& options) {
    RunOptions run;
    run.show = options.show;
    run.site = options.site;
    if (options.length) run.length = fromSeconds(*options.length);
    run.fromCue = options.fromCue;
    run.recordTo = options.record;
    run.pictures = options.pictures;
    run.seed = options.seed;
    return run;
}

void declareRehearse(CLI::App& command, Options& options) {
    command.add_option("show", options.show, "a show's folder (default: shows/light-movement)");
    command.add_option("--site", options.site, "the site to simulate (default: config/simulated)");
    declareCommon(command, options);
    command.add_option("--seed", options.seed, "of the simulated site's noise")->capture_default_str();
    command.add_flag("--window", options.window, "show the pictures in windows");
    command.add_flag("--as-fast-as-possible", options.asFastAsPossible, "on a stepped clock: the same bytes every time");
    command.add_flag("--by-hand", options.byHand,
                     "press no GO: wait for space (GO), b (back), 0 (blackout); s takes pictures, q ends");
}

Result<void> rehearse(const Options& options) {
    RunOptions run = commonOf(options);
    if (run.show.empty()) run.show = dataFolder() / "shows/light-movement";
    if (run.site.empty()) run.site = dataFolder() / "config/simulated";
    // Without an end there is nothing to spread the cues over; a minute is what a passer-by stays.
    if (!run.length && !options.byHand) run.length = std::chrono::seconds(60);
    if (!run.length && options.asFastAsPossible) return Error("--as-fast-as-possible needs an end: add --seconds T");
    run.backends = options.window ? Backends::SimulatedWindows : Backends::SimulatedHeadless;
    run.asFastAsPossible = options.asFastAsPossible;
    run.handsOff = !options.byHand;
    return runAndReport(run, options.report, "rehearsal");
}

void declareRun(CLI::App& command, Options& options) {
    command.add_option("show", options.show, "a show's folder")->required();
    command.add_option("--site", options.site, "the site: a folder or a site.yaml")->required();
    declareCommon(command, options);
}

Result<void> runNight(const Options& options) { return runAndReport(commonOf(options), options.report, "show"); }

}  // namespace

void addRehearseCommand(CLI::App& program, Action& action) {
    addCommand<Options>(program, action, "rehearse", "Plays a show on the simulated site", declareRehearse, rehearse);
}

void addRunCommand(CLI::App& program, Action& action) {
    addCommand<Options>(program, action, "run", "Plays a show on the site's own devices", declareRun, runNight);
}

}  // namespace fantascope::app
