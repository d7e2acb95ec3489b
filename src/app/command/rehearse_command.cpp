#include "app/base/data_folder.h"
#include "app/base/interrupt.h"
#include "app/command/commands.h"
#include "app/keys/run_keys.h"
#include "app/live/run_console.h"
#include "app/live/show_run.h"
#include "app/site/relay_guard.h"

#include <fmt/format.h>

#include <cstdio>
#include <iostream>

namespace fantascope::app {
namespace {

constexpr int kPagePort = 8080;

struct Options {
    std::string show, site, fromCue, record, at;
    std::string pictures = RunOptions{}.pictures, journal;
    std::optional<double> length;  // seconds
    std::filesystem::path report;
    std::uint64_t seed = 1;
    std::optional<web::Server::Options> page;
    bool window = false, asFastAsPossible = false, byHand = false;
};

Result<void> runAndReport(const RunOptions& run) {
    const Interrupt interrupt(Interrupt::Second::IsCounted);
    RunReport report;
    {
        const SteadyClock clock;
        RunConsole console(clock, std::cerr, standardErrorIsTerminal() ? standardErrorColumns : std::function<int()>());
        report = TRY(runShow(run, interrupt, [&](const RunStatus& status) { console.tell(status); }));
    }
    // If nobody reads the output any more, the summary is lost; that is no error.
    std::fputs((summaryOf(report) + "\n").c_str(), stdout);
    std::fflush(stdout);
    if (!report.unsafe.empty())
        return Error(sentenceOf(report.unsafe) +
                     (run.backends == Backends::AsDeclared
                          ? fmt::format(". The relay guard goes on trying for {:g} s", seconds(RelayGuard::kPatience))
                          : ""));
    return {};
}

// "localhost:8080", a part of it, or nothing. Returns why not, or "".
std::string readPlaceOfPage(const std::string& text, web::Server::Options& place) {
    const std::size_t colon = text.rfind(':');
    const std::string address = colon == std::string::npos ? "localhost" : text.substr(0, colon);
    const auto port =
        text.empty() ? std::optional(kPagePort) : wholeNumber(colon == std::string::npos ? text : text.substr(colon + 1));
    if (address != "localhost" && address != "127.0.0.1")
        return fmt::format("'{}': the page is for this machine alone: write localhost:{}", text, kPagePort);
    if (!port || *port < 0 || *port > 65535) return fmt::format("'{}' has no port: write localhost:{}", text, kPagePort);
    place.port = *port;
    return "";
}

void declareCommon(Command& command, Options& options) {
    command.add("--seconds", options.length, "end after this much show time").range(0.1, 1e6);
    command.add("--from", options.fromCue, "enter this cue at once, by its name or number");
    command.add("--record", options.record, "write videos, traces and a contact sheet to this folder, or one video to FILE.mp4");
    command.add("--pictures", options.pictures, "folder for the pictures that the key s takes").showDefault();
    command.add("--journal", options.journal,
                "write what is pressed and happens to this folder; a run that died goes on from there");
    command
        .addParsed(
            "--console", [&](const std::string& text) { return readPlaceOfPage(text, options.page.emplace()); },
            fmt::format("serve a page to operate the show, for a browser on this machine (default: localhost:{})", kPagePort))
        .orNothing()
        .typeName("[ADDRESS:PORT]");
    command.add("--report", options.report, "write the run's figures to this JSON file (docs/report.md)");
    command.footer(runKeysHelp());
}

RunOptions commonOf(const Options& options) {
    RunOptions run;
    run.show = options.show;
    run.site = options.site;
    if (options.length) run.length = fromSeconds(*options.length);
    run.fromCue = options.fromCue;
    run.recordTo = options.record;
    run.pictures = options.pictures;
    run.report = options.report;
    run.journal = options.journal;
    run.page = options.page;
    run.seed = options.seed;
    return run;
}

void declareRehearse(Command& command, Options& options) {
    command.add("show", options.show, "a show's folder (default: shows/light-movement)");
    command.add("--site", options.site, "the site to simulate (default: config/simulated)");
    declareCommon(command, options);
    command.add("--seed", options.seed, "seed of the simulated site's noise").showDefault();
    command.add("--at", options.at,
                "begin as at this date and time of the place: '2026-12-24 21:30'; for a show with a schedule");
    command.addFlag("--window", options.window, "show the pictures in windows");
    command.addFlag("--as-fast-as-possible", options.asFastAsPossible, "use a stepped clock: the same bytes every time");
    command.addFlag("--by-hand", options.byHand, "press no GO, and wait for the keys below");
}

Result<void> rehearse(const Options& options) {
    RunOptions run = commonOf(options);
    if (run.show.empty()) run.show = TRY(dataFolder()) / "shows/light-movement";
    if (run.site.empty()) run.site = TRY(dataFolder()) / "config/simulated";
    // The cues are spread over the length. A minute is how long a passer-by stays.
    if (!run.length && !options.byHand) run.length = std::chrono::seconds(60);
    if (!run.length && options.asFastAsPossible) return Error("--as-fast-as-possible needs an end: add --seconds T");
    if (options.page && options.asFastAsPossible) return Error("--console needs real time: leave out --as-fast-as-possible");
    run.backends = options.window ? Backends::SimulatedWindows : Backends::SimulatedHeadless;
    run.asFastAsPossible = options.asFastAsPossible;
    run.handsOff = !options.byHand;
    if (!options.at.empty()) run.at = TRY(show::dateAndTimeOf(options.at));
    return runAndReport(run);
}

void declareRun(Command& command, Options& options) {
    command.add("show", options.show, "a show's folder").required();
    command.add("--site", options.site, "the site: a folder or a site.yaml").required();
    declareCommon(command, options);
}

Result<void> runNight(const Options& options) { return runAndReport(commonOf(options)); }

}  // namespace

void addRehearseCommand(Program& program) {
    addCommand<Options>(program, "rehearse", "Play a show on the simulated site", declareRehearse, rehearse);
}

void addRunCommand(Program& program) {
    addCommand<Options>(program, "run", "Play a show on the site's own devices", declareRun, runNight);
}

}  // namespace fantascope::app
