#include "app/export_command.h"

#include "app/data_folder.h"
#include "app/frame_file.h"
#include "app/frame_run.h"
#include "app/geometry_options.h"
#include "app/hand.h"
#include "app/off_screen.h"
#include "app/programme.h"
#include "app/report.h"
#include "app/site_models.h"

#include "core/config.h"
#include "core/geometry.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

namespace fantascope::app {
namespace {

namespace fs = std::filesystem;

constexpr double kShowSeconds = 60;  // of a show without --seconds, as in a rehearsal
constexpr double kPatternRate = 30;  // frames a second of a pattern without --fps
constexpr int kPatternRows = 1080;   // of a pattern without --size
constexpr double kMostFrames = 10'000'000;

struct Options {
    fs::path what, file, report;
    std::string output, cue, from;
    fs::path site;
    std::optional<double> seconds, frameRate;
    std::optional<glm::ivec2> size;
    std::optional<Alpha> alpha;
    bool canvas = false;
};

void declare(CLI::App& command, Options& options) {
    command.add_option("SHOW", options.what, "A show's folder, or a single P.pattern.yaml")->required();
    command
        .add_option("-o", options.file,
                    "What to write: a folder of PNG pictures, FILE.mp4, FILE.mov (ProRes 4444) or FILE.mkv (FFV1)")
        ->required();
    command.add_option("--output", options.output, "The output of the site that is exported; needed for a show");
    command.add_option("--site", options.site, "The site that the show plays on (default: config/simulated)");
    CLI::Option* const cue =
        command.add_option("--cue", options.cue, "This cue alone, faded in, the movement from its beginning");
    command.add_option("--from", options.from, "Enter this cue at once and play on from there")->excludes(cue);
    command
        .add_option(
            "--seconds", options.seconds,
            fmt::format("How much show time (default: {} s; a pattern or a single cue: one loop of the movement)", kShowSeconds))
        ->check(CLI::Range(0.001, 1e6));
    command.add_option("--fps", options.frameRate, "Frames a second of show time (default: the output's; a pattern: 30)")
        ->check(CLI::Range(1.0, 1000.0));
    addSizeOption(command, "--size", options.size, "Of a frame (default: the output's; a pattern: 1080 rows)");
    command
        .add_option(
            "--alpha", options.alpha,
            "Black becomes clear, for programs that composite in stored or in linear values; none: the frame as the projector "
            "gets it (default: stored; none in an .mp4, which has no alpha)")
        ->transform(CLI::CheckedTransformer(
            std::map<std::string, Alpha>{{"none", Alpha::None}, {"stored", Alpha::Stored}, {"linear", Alpha::Linear}}));
    command.add_flag("--canvas", options.canvas, "The picture before the output's keystone, as a light mask wants it");
    command.add_option("--report", options.report, "Also write figures, as JSON");
}

// What is to be drawn, frame by frame.
struct Film {
    glm::ivec2 size{0};
    std::array<glm::dvec2, 4> corners{};
    std::vector<render::PictureSource> sources;
    double frameRate = 0;
    double seconds = 0;
    std::function<const show::OutputState&(Time)> stateAt;  // for times that rise
};

// How long the slowest of the sources' movements takes to come round; 0 where nothing moves.
double loopOf(const std::vector<render::PictureSource>& sources) {
    double longest = 0;
    for (const render::PictureSource& source : sources)
        if (const auto* pattern = std::get_if<render::PatternSource>(&source); pattern != nullptr && pattern->motion)
            longest = std::max(longest, seconds(pattern->motion->period()));
    return longest;
}

glm::ivec2 sizeOfCanvas(int rows, double aspect) { return {2 * std::max(1L, std::lround(rows * aspect / 2)), rows}; }

Result<Film> filmOfPattern(const Options& options) {
    if (!options.output.empty() || !options.cue.empty() || !options.from.empty() || !options.site.empty())
        return Error(
            fmt::format("{}: is a single pattern; --output, --site, --cue and --from are for shows", options.what.string()));
    const render::PatternSource pattern = TRY(readPatternSource(options.what));
    Film film;
    film.size = options.size.value_or(sizeOfCanvas(kPatternRows, pattern.pattern->aspect()));
    film.corners = rectangleCorners(film.size.x, film.size.y);
    film.sources = {pattern};
    film.frameRate = options.frameRate.value_or(kPatternRate);
    film.seconds = options.seconds.value_or(loopOf(film.sources));
    film.stateAt = [state = show::OutputState{{{0, 1.0f}}}](Time) -> const show::OutputState& { return state; };
    return film;
}

// Plays a show without its devices: GO is pressed as in a rehearsal.
class ShowFrames {
public:
    ShowFrames(show::CueList cues, std::optional<show::Input> firstInput, std::size_t output, std::size_t presses, Time length)
        : playback_(std::move(cues)), schedule_(presses, firstInput.has_value(), length), output_(output) {
        if (firstInput) playback_.apply(*firstInput);
    }
    const show::OutputState& at(Time time) {
        for (; tickTime(tick_, Hand::kRate) <= time; ++tick_)
            if (const Time moment = tickTime(tick_, Hand::kRate); schedule_.due(moment))
                playback_.apply({moment, show::Input::Kind::Go, 0});
        playback_.stateAt(time, state_);
        return state_.outputs[output_];
    }

private:
    show::Playback playback_;
    GoSchedule schedule_;
    std::size_t output_;
    std::int64_t tick_ = 0;
    show::ShowState state_;
};

Result<Film> filmOfShow(const Options& options) {
    if (options.output.empty()) return Error("export needs --output NAME, the output of the site whose picture is wanted");
    RunOptions run;
    run.show = options.what;
    run.site = options.site.empty() ? dataFolder() / "config/simulated" : options.site;
    run.fromCue = options.cue.empty() ? options.from : options.cue;
    Programme programme = TRY(readProgramme(run));
    const std::size_t index = TRY(outputNamed(programme.site, options.output));
    const show::Output& output = programme.site.outputs[index];

    Film film;
    film.size = options.size.value_or(output.size);
    film.corners = output.corners;
    for (glm::dvec2& corner : film.corners) corner *= glm::dvec2(film.size) / glm::dvec2(output.size);
    if (options.canvas) film.corners = rectangleCorners(film.size.x, film.size.y);
    film.frameRate = options.frameRate.value_or(output.refreshRate);
    film.sources = std::move(programme.sources);

    show::CueList& cues = programme.cues;
    const std::size_t last = cues.cues.size();
    std::size_t entered = programme.firstInput ? static_cast<std::size_t>(programme.firstInput->cue) + 1 : 0;
    film.seconds = options.seconds.value_or(kShowSeconds);
    if (!options.cue.empty()) {  // it stands already, and nothing comes after it
        show::CueList::Cue& cue = cues.cues[entered - 1];
        programme.firstInput->at = -cue.fade;
        cue.follow.reset();
        if (const double loop = loopOf(film.sources); !options.seconds && loop > 0) film.seconds = loop;
        entered = last;
    }
    const auto frames =
        std::make_shared<ShowFrames>(std::move(cues), programme.firstInput, index, last - entered, fromSeconds(film.seconds));
    film.stateAt = [frames](Time time) -> const show::OutputState& { return frames->at(time); };
    return film;
}

bool isPattern(const fs::path& path) {
    std::error_code ignored;
    if (!fs::is_regular_file(path, ignored)) return false;
    const auto root = ConfigNode::load(path);
    if (!root) return false;
    if (const auto entries = root->entries())
        for (const auto& [key, value] : *entries)
            if (key == "fantascope") return value.text().has_value() && *value.text() == "pattern";
    return false;
}

Result<void> run(const Options& options) {
    const Film film = TRY(isPattern(options.what) ? filmOfPattern(options) : filmOfShow(options));
    const double wanted = film.seconds * film.frameRate;
    if (wanted > kMostFrames) return Error(fmt::format("{:.0f} frames are too many; give a smaller --seconds or --fps", wanted));
    const std::int64_t frames = std::max<std::int64_t>(1, std::llround(wanted));

    const auto screen = TRY(OffScreen::open(film.size, film.corners, film.sources));
    const auto file = TRY(FrameFile::open(options.file, film.size, film.frameRate, options.alpha));
    const std::int64_t made = TRY(makeFrames("export", frames, [&](std::int64_t number) {
        const Time time = tickTime(number, film.frameRate);
        return file->write(screen->draw(film.stateAt(time), time));
    }));
    if (made > 0) TRY(file->finish());
    if (!options.report.empty()) {
        Report report;
        report["frames"] = made;
        report["seconds"] = seconds(tickTime(made, film.frameRate));
        report["fps"] = film.frameRate;
        report["size"] = {film.size.x, film.size.y};
        report["alpha"] = name(file->alpha());
        report["stop_reason"] = made == frames ? "length" : "interrupted";
        TRY(writeReport(options.report, report));
    }
    fmt::print("{}: {} x {}, {}\n", options.file.string(), film.size.x, film.size.y, outcomeOf(made, frames, film.frameRate));
    return {};
}

}  // namespace

void addExportCommand(CLI::App& program, Action& action) {
    addCommand<Options>(program, action, "export", "Write what an output shows as pictures with alpha or as a video", declare,
                        run);
}

}  // namespace fantascope::app
