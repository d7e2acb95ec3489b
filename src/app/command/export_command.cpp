#include "app/base/frame_run.h"
#include "app/base/geometry_options.h"
#include "app/base/report.h"
#include "app/command/commands.h"
#include "app/export/film.h"
#include "app/export/frame_file.h"

#include <fmt/format.h>

namespace fantascope::app {
namespace {

namespace fs = std::filesystem;

struct Options {
    FilmRequest film;
    fs::path file, report;
    std::optional<Alpha> alpha;
};

void declare(Command& command, Options& options) {
    FilmRequest& film = options.film;
    command.add("SHOW", film.what, "A show's folder, or a single P.pattern.yaml").required();
    declareFilmOptions(command, film);
    addOutOption(command, options.file,
                 "What to write: a folder of PNG pictures, FILE.mp4, FILE.mov (ProRes 4444) or FILE.mkv (FFV1)")
        .required();
    command
        .add("--seconds", film.seconds,
             "Length in show time (default: 60; for a pattern or a single cue: one loop of the movement)")
        .range(0.001, 1e6);
    command.add("--fps", film.frameRate, "Frames per second of show time (default: the output's; for a pattern: 30)")
        .range(1.0, 1000.0);
    addSizeOption(command, "--size", film.size, "Frame size (default: the output's; for a pattern or a canvas: 1080 rows)");
    command.addChoice<Alpha>(
        "--alpha", options.alpha, {{"none", Alpha::None}, {"stored", Alpha::Stored}, {"linear", Alpha::Linear}},
        "Make black transparent, for programs that composite stored or linear values; none: the frame as the projector "
        "gets it (default: stored; none for an .mp4, which has no alpha)");
    command.addFlag("--canvas", film.canvas, "The whole canvas, without the output's warp, as for a light mask");
    command.add("--report", options.report, "Also write figures, as JSON (docs/report.md)");
    command.footer("During the export, the space bar pauses and resumes; Escape, q and Ctrl-C end it with the frames so far.");
}

Result<void> run(const Options& options) {
    Film film = TRY(Film::open(options.film));
    const auto file = TRY(FrameFile::open(options.file, film.size(), film.frameRate(), options.alpha));
    const std::int64_t made = TRY(makeFrames(
        "export", film.frames(), [&](std::int64_t number) { return file->write(film.at(tickTime(number, film.frameRate()))); }));
    if (made > 0) TRY(file->finish());
    if (!options.report.empty()) {
        Report report;
        report["frames"] = made;
        report["seconds"] = seconds(tickTime(made, film.frameRate()));
        report["fps"] = film.frameRate();
        report["size"] = {film.size().x, film.size().y};
        report["alpha"] = name(file->alpha());
        report["stop_reason"] = made == film.frames() ? "length" : "interrupted";
        TRY(writeReport(options.report, report));
    }
    fmt::print("{}: {} x {}, {}\n", options.file.string(), film.size().x, film.size().y,
               outcomeOf(made, film.frames(), film.frameRate()));
    return {};
}

}  // namespace

void addExportCommand(Program& program) {
    addCommand<Options>(program, "export", "Write an output's frames as pictures with alpha or as a video", declare, run);
}

}  // namespace fantascope::app
