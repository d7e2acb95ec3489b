#include "app/base/attendance.h"
#include "app/base/progress.h"
#include "app/base/report.h"
#include "app/command/commands.h"
#include "app/lens/board_sheet.h"
#include "app/lens/board_watch.h"
#include "app/lens/lens_camera.h"
#include "app/lens/lens_file.h"
#include "app/lens/lens_result.h"
#include "app/lens/light_measurement.h"
#include "app/lens/recorded_views.h"
#include "app/lens/simulated_hand.h"
#include "app/site/site_file.h"

#include "core/config/config_edit.h"
#include "core/file.h"
#include "core/text.h"

#include <fmt/format.h>

#include <iostream>
#include <optional>

namespace fantascope::app {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

constexpr Time kCameraWithin = 8s;  // some cameras take seconds for their first picture

struct Options {
    fs::path site, board, pictures, report;
    Paper paper = Paper::A4;
    std::vector<int> size;
    std::uint64_t seed = 1;
    bool simulate = false, kept = false, light = false, write = false, undo = false;
};

void declare(Command& command, Options& options) {
    command.add("SITE", options.site, "A site's folder, or a site.yaml");
    const Option board = command.add("--board", options.board,
                                     "Make the lens board: a PDF or SVG to print in true size, or a PNG for a flat screen");
    command.addChoice<Paper>("--paper", options.paper, {{"a4", Paper::A4}, {"a3", Paper::A3}}, "The sheet of the PDF or SVG")
        .showDefault();
    command.add("--size", options.size, "Width and height of the PNG, pixels (default: 1920 1080)").expected(2);
    command
        .add("--pictures", options.pictures, "Read recorded pictures of the board, PNG or JPEG, from this folder, not the camera")
        .excludes(board);
    command.addFlag("--kept", options.kept, "Measure nothing: take the lens that is kept for the site's camera");
    command.addFlag("--light", options.light,
                    "Measure how the camera stores light instead: a dark frame with covered lens, then exposures of known times");
    command.addFlag("--simulate", options.simulate, "A simulated person shows the board to the simulated site's camera");
    command.addFlag("--write", options.write,
                    "Write a good lens into the site file, which is kept as FILE.previous, and keep it for this camera");
    command.addFlag("--undo", options.undo,
                    "Measure nothing: go back to the site file as it was; once more, and it is the new one");
    command.add("--report", options.report, "Write the figures to this JSON file (docs/report.md)");
    command.add("--seed", options.seed, "Seed of the simulated camera's noise").showDefault();
    command.footer(
        "Hold the board still at many places of the picture, tilted to all sides; the program says what is missing. Escape, q "
        "and "
        "Ctrl-C end it with the best so far. See docs/lens.md.");
}

Result<void> makeBoard(const Options& options) {
    const std::string ending = endingOf(options.board);
    if (ending == ".png") {
        const glm::ivec2 size = options.size.empty() ? glm::ivec2(1920, 1080) : glm::ivec2(options.size[0], options.size[1]);
        TRY(TRY(boardPicture(size)).write(options.board));
    } else if (ending == ".pdf" || ending == ".svg") {
        TRY(boardSheet(options.paper).writeAsPaper(options.board));
    } else {
        return Error(fmt::format("{}: the board's name must end in .pdf, .svg or .png", options.board.string()));
    }
    fmt::print("{}: the lens board, {} x {} squares{}\n", options.board.string(), vision::LensBoard::kSquares.x,
               vision::LensBoard::kSquares.y, ending == ".png" ? "" : fmt::format(" of {:g} mm", squareMm(options.paper)));
    return {};
}

// Waits for the camera's first frame. Error: it gives none; it has another size than the site file
// says.
Result<void> awaitCamera(LensCamera& camera, const show::Site& site, const Clock& clock, Attendance& attendance) {
    std::shared_ptr<const CameraFrame> frame;
    for (const Time limit = clock.now() + kCameraWithin; !frame && clock.now() < limit && !camera.hasEnded();) {
        if (!attendance.goesOn()) return Error("it was ended before the camera gave a picture");
        frame = camera.next();
    }
    if (!frame) {
        const std::string why = camera.status().detail;
        return Error("the camera gives no picture" +
                     (why.empty() ? "; look at its cable, and close other programs that use it" : ": " + why));
    }
    const glm::ivec2 its(frame->image.width(), frame->image.height()), declared = site.nominalCamera->size;
    if (its != declared)
        return Error(fmt::format("the camera's pictures have {} x {} pixels, the site file says {} x {}; correct camera: size",
                                 its.x, its.y, declared.x, declared.y));
    return {};
}

// What a person should know of the camera before it is measured.
void tellOf(const CameraDescription& camera, const show::Site& site) {
    if (camera.card.empty()) return;
    std::string words = identityOf(camera);
    if (!camera.format.empty()) words += ": " + camera.format;
    if (!camera.lacks.empty()) words += "; of the site file's settings, " + camera.lacks;
    fmt::print("{}\n", printableLines(words));
    if (const std::string mismatch = lensMismatch(site, camera); !mismatch.empty())
        fmt::print("note: {}\n", printableLines(mismatch));
}

// The views that a person shows to the camera, until nothing is missing or it is ended.
Result<BoardWatch> watchBoard(LensCamera& camera, const show::Site& site, Clock& clock, Attendance& attendance) {
    Progress progress("lens", clock, std::cerr, standardErrorIsTerminal());
    progress.update(0, "waiting for the camera");
    TRY(awaitCamera(camera, site, clock, attendance));
    tellOf(camera.description(), site);
    BoardWatch watch;
    Time heard = clock.now();
    while (!watch.isComplete() && attendance.goesOn() && !camera.hasEnded()) {
        const auto frame = camera.next();
        if (!frame) {
            if (clock.now() - heard < kCameraWithin) continue;
            if (watch.views().empty()) return Error("the camera is gone: " + camera.status().detail);
            fmt::print("the camera is gone: {}\n", printableLines(camera.status().detail));
            break;
        }
        heard = clock.now();
        if (glm::ivec2(frame->image.width(), frame->image.height()) != site.nominalCamera->size) continue;
        watch.look(frame->image);
        progress.update(watch.done(), fmt::format("{} views; {}", watch.views().size(), watch.advice()));
    }
    return watch;
}

// A lens, and the camera that it is of; its card is empty where nobody knows.
struct Measured {
    LensResult lens;
    CameraDescription camera;
};

Result<Measured> fromPictures(const Options& options, const std::optional<show::Site>& site) {
    SteadyClock clock;
    Attendance attendance(clock);
    Progress progress("lens", clock, std::cerr, standardErrorIsTerminal());
    const auto size = site ? std::optional(site->nominalCamera->size) : std::nullopt;
    const auto goesOn = [&](double done) {
        progress.update(done, "looking for the board");
        return attendance.goesOn();
    };
    const RecordedViews recorded = TRY(recordedViews(options.pictures, size, goesOn));
    LensResult result = TRY(lensOf(recorded.views, recorded.missed).in(options.pictures.string()));
    for (std::size_t i = 0; i < recorded.views.size(); ++i)
        if (!result.fit.views[i].used)
            fmt::print("{}: left out, it misses by {:.1f} px\n", recorded.names[i], result.fit.views[i].rms);
    if (recorded.missed.pictures > 0) fmt::print("no board in {} other pictures\n", recorded.missed.pictures);
    return Measured{std::move(result), {}};
}

Result<std::unique_ptr<LensCamera>> cameraFor(const Options& options, const show::Site& site, Clock& clock) {
    if (options.simulate) return simulatedHand(site, options.seed);
    const Interrupt interrupt;
    return openCamera(site, clock, interrupt);
}

Result<Measured> fromCamera(const Options& options, const show::Site& site) {
    SteadyClock clock;
    const auto camera = TRY(cameraFor(options, site, clock));
    Attendance attendance(clock);
    const BoardWatch watch = TRY(watchBoard(*camera, site, clock, attendance));
    LensResult result = TRY(lensOf(watch.views(), watch.missed(), watch.thrownAway()));
    return Measured{std::move(result), camera->description()};
}

// Writes the lens where `--write` wants it, and says where.
Result<void> write(const show::Site& site, const KeptLens& lens) {
    TRY(writeLens(site, lens));
    fmt::print("written to {}\n", site.file.string());
    if (lens.card.empty()) {
        fmt::print("not kept for other sites: pictures do not say which camera took them\n");
        return {};
    }
    const fs::path file = TRY(keepLens(TRY(lensFolder()), lens));
    fmt::print("kept for other sites in {}{}\n", file.string(),
               lens.serial.empty() ? "; the camera has no serial number, so all of its model count as this one" : "");
    return {};
}

Result<void> takeKept(const Options& options, const show::Site& site) {
    SteadyClock clock;
    const auto camera = TRY(cameraFor(options, site, clock));
    Attendance attendance(clock);
    TRY(awaitCamera(*camera, site, clock, attendance));
    const CameraDescription description = camera->description();
    const auto kept = TRY(keptLens(TRY(lensFolder()), description, site.nominalCamera->size));
    if (!kept || kept->fieldOfView == 0)
        return Error(fmt::format("no lens is kept for '{}' at {} x {} pixels; measure it with 'fantascope lens SITE --write'",
                                 identityOf(description), site.nominalCamera->size.x, site.nominalCamera->size.y));
    constexpr double kDegrees = 180 / 3.14159265358979323846;
    fmt::print("{}: field of view {:.2f} degrees, centre {:.1f}, {:.1f}, k1 {:.4f}, k2 {:.4f}; rms {:.2f} px over {} views\n",
               kept->camera(), kept->fieldOfView * kDegrees, kept->centre.x, kept->centre.y, kept->k1, kept->k2, kept->rms,
               kept->views);
    if (!options.write) return {};
    TRY(writeLens(site, *kept));
    fmt::print("written to {}\n", site.file.string());
    return {};
}

// The site's camera with its exposure locked, units of 100 us, or as the site file says.
Result<std::unique_ptr<LensCamera>> openExposed(const show::Site& site, std::optional<int> exposure, Clock& clock,
                                                const Interrupt& interrupt) {
    if (!exposure) return openCamera(site, clock, interrupt);
    ConfigDocument document = TRY(ConfigDocument::parse(site.text, site.file));
    TRY(document.set({"camera", "device", "exposure"}, static_cast<double>(*exposure)));
    const show::Site exposed = TRY(show::parseSite(document.text(), site.file));
    return openCamera(exposed, clock, interrupt);
}

// The exposure that the site file asks for, units of 100 us, or a usual one.
int exposureOf(const show::Site& site) {
    constexpr int kUsual = 100, kMost = 1'000'000;
    const auto keys = site.camera->options.entries();
    for (const auto& [key, value] : keys ? *keys : std::vector<std::pair<std::string, ConfigNode>>())
        if (const auto exposure = value.integer(1, kMost); key == "exposure" && exposure) return static_cast<int>(*exposure);
    return kUsual;
}

Result<void> measureLight(const Options& options, const show::Site& site) {
    if (options.simulate) return Error("the simulated camera stores sRGB, there is nothing to measure; leave out --light");
    SteadyClock clock;
    const Interrupt interrupt;
    Progress progress("light", clock, std::cerr, standardErrorIsTerminal());
    LightMeasurement measurement(
        [&](std::optional<int> exposure) { return openExposed(site, exposure, clock, interrupt); }, clock,
        {[&] { return !interrupt.requested(); }, [&](double done, const std::string& doing) { progress.update(done, doing); }});
    const LightResult light = TRY(measurement.measure(exposureOf(site)));
    fmt::print("{}\n{}\n", printableLines(identityOf(light.camera)), light.sentence());
    Report report;
    report["camera"] = identityOf(light.camera);
    report["dark"] = light.dark;
    report["hot_pixels"] = light.light.hotPixels.size();
    report["exposures"] = light.exposures;
    report["rms"] = light.rms;
    report["response"] = light.light.response;
    if (!light.trouble.empty()) report["trouble"] = light.trouble;
    report["written"] = options.write;
    if (!options.report.empty()) TRY(writeReport(options.report, report));
    if (!options.write) return {};
    KeptLens kept;
    kept.card = light.camera.card;
    kept.serial = light.camera.serial;
    kept.size = site.nominalCamera->size;
    kept.light = light.light;
    return write(site, kept);
}

Result<void> run(const Options& options) {
    if (!options.board.empty()) return makeBoard(options);
    std::optional<show::Site> site;
    if (options.site.empty()) {
        if (options.pictures.empty() || options.write)
            return Error("a site is needed, or --pictures FOLDER, or --board FILE; see fantascope lens --help");
    } else if (options.undo) {
        const fs::path file = TRY(undoWrite(options.site));
        fmt::print("{0} is again as it was; what it replaces is kept as {0}.previous\n", file.string());
        return {};
    } else {
        site = TRY(readSite(options.site));
        if (!site->camera)
            return Error(fmt::format("{}: there is no camera; add one (docs/site-format.md)", site->file.string()));
        if (options.kept) return takeKept(options, *site);
        if (options.light) return measureLight(options, *site);
    }
    const Measured measured = TRY(options.pictures.empty() ? fromCamera(options, *site) : fromPictures(options, site));
    const LensResult& lens = measured.lens;
    fmt::print("{}\n", lens.sentence());
    if (lens.isGood() && !lens.needs.places.empty())
        fmt::print("note: the board was never at the {} of the picture\n", fmt::join(lens.needs.places, ", "));
    Report report = lens.report();
    report["camera"] = identityOf(measured.camera);
    report["written"] = options.write && lens.isGood();
    if (options.write && lens.isGood()) TRY(write(*site, KeptLens::of(lens, measured.camera)));
    if (!options.report.empty()) TRY(writeReport(options.report, report));
    if (!lens.isGood()) return Error("the lens is not good enough; what was set before is kept");
    return {};
}

}  // namespace

void addLensCommand(Program& program) {
    addCommand<Options>(program, "lens", "Measure the camera's lens with a printed board", declare, run);
}

}  // namespace fantascope::app
