#include "app/export/film.h"

#include "app/base/command.h"
#include "app/base/data_folder.h"
#include "app/keys/go_schedule.h"
#include "app/live/hand.h"
#include "app/live/programme.h"
#include "app/site/site_models.h"

#include "core/config/config.h"
#include "core/file.h"
#include "core/fit.h"
#include "core/log.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fantascope::app {
namespace {

namespace fs = std::filesystem;

constexpr double kShowSeconds = 60;  // of a show without --seconds, as in a rehearsal
constexpr double kPatternRate = 30;  // frames per second of a pattern without --fps
constexpr int kCanvasRows = 1080;    // of a pattern or a canvas without --size
constexpr double kMaxFrames = 1e7;   // four days at 30 Hz

// The length of a source's loop, seconds; 0 if it does not move or does not loop.
double loopOf(const render::PatternSource& source) { return seconds(source.motion->period()); }
double loopOf(const render::SolidSource&) { return 0; }
double loopOf(const render::FoliageSource& source) {
    double longest = 0;
    for (const render::ShadowLayer& layer : source.layers) longest = std::max(longest, loopOf(layer.leaves));
    return longest;
}
double loopOf(const render::CausticsSource&) { return 0; }
double loopOf(const render::MirrorBallSource&) { return 0; }
double loopOf(const render::ImageSource&) { return 0; }
double loopOf(const render::VideoSource& source) { return seconds(source.stream->content().length) / source.speed; }
double loopOf(const render::CameraSource&) { return 0; }
double loopOf(const render::ShadowSource& source) { return seconds(render::lengthOf(source)); }

// The length of the longest loop.
double loopOf(const render::PictureSources& sources) {
    double longest = 0;
    for (const auto& [id, source] : sources)
        longest = std::max(longest, std::visit([](const auto& kind) { return loopOf(kind); }, source.picture));
    return longest;
}

// The aspect of the first source that has one.
std::optional<double> aspectOf(const render::PictureSources& sources) {
    for (const auto& [id, source] : sources)
        if (const auto aspect = render::aspectOf(source)) return aspect;
    return std::nullopt;
}

double shapeOf(glm::ivec2 size) { return static_cast<double>(size.x) / size.y; }

// The width is even, as videos need it.
glm::ivec2 sizeOfCanvas(int rows, double aspect) { return {2 * std::max(1L, std::lround(rows * aspect / 2)), rows}; }

// Plays a show without its devices; GO is pressed as in a rehearsal.
class ShowFrames {
public:
    ShowFrames(show::CueList cues, const std::optional<show::Input>& firstInput, GoSchedule schedule)
        : playback_(std::move(cues)), schedule_(schedule) {
        if (firstInput) playback_.apply(*firstInput);
    }
    const show::ShowState& at(Time time) {
        for (; tickTime(tick_, Hand::kRate) <= time; ++tick_)
            if (const Time moment = tickTime(tick_, Hand::kRate); schedule_.due(moment))
                playback_.apply({moment, show::Input::Kind::Go, 0});
        playback_.foresee(time);
        playback_.stateAt(time, state_);
        return state_;
    }

private:
    show::Playback playback_;
    GoSchedule schedule_;
    std::int64_t tick_ = 0;
    show::ShowState state_;
};

// Whether the file is a pattern. The kind is read from the file's header.
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

}  // namespace

void declareFilmOptions(Command& command, FilmRequest& request) {
    addProjectorOption(command, request.output, "For a show: the projector whose picture to show");
    command.add("--site", request.site, "For a show: the site to play on (default: config/simulated)");
    const Option cue =
        command.add("--cue", request.cue, "For a show: only this cue, faded in, with the movement from its beginning");
    command.add("--from", request.from, "For a show: enter this cue at once and play on").excludes(cue);
}

Result<Film> Film::open(const FilmRequest& request) {
    if (!fs::exists(request.what)) return readFile(request.what).error();
    Film film = TRY(isPattern(request.what) ? ofPattern(request) : ofShow(request));
    const double wanted = film.seconds_ * film.frameRate_;
    if (wanted > kMaxFrames) return Error(fmt::format("{:.0f} frames are too many; lower --seconds or --fps", wanted));
    film.frames_ = std::max<std::int64_t>(1, std::llround(wanted));
    return film;
}

Result<Film> Film::ofPattern(const FilmRequest& request) {
    if (!request.output.empty() || !request.cue.empty() || !request.from.empty() || !request.site.empty())
        return Error(
            fmt::format("{}: is a single pattern; --output, --site, --cue and --from are for shows only", request.what.string()));
    const auto sources = render::PictureSources::numbered({TRY(readPatternSource(request.what))});
    Film film;
    film.size_ = request.size.value_or(sizeOfCanvas(kCanvasRows, *aspectOf(sources)));
    film.frameRate_ = request.frameRate.value_or(kPatternRate);
    film.seconds_ = request.seconds.value_or(loopOf(sources));
    film.screen_ = TRY(OffScreen::open(film.size_, sources));
    film.seenAt_ = [state = show::OutputState{{{0, 1.0f}}}](Time) { return Seen{state, {}}; };
    return film;
}

Result<Film> Film::ofShow(const FilmRequest& request) {
    if (request.output.empty())
        return Error(fmt::format("{}: a show needs --output NAME, one of the site's outputs", request.what.string()));
    RunOptions run;
    run.show = request.what;
    run.site = request.site.empty() ? TRY(dataFolder()) / "config/simulated" : request.site;
    run.asFastAsPossible = true;  // not in real time: a frame waits for its video
    run.fromCue = request.cue.empty() ? request.from : request.cue;
    Programme programme = TRY(readProgramme(run));
    const std::size_t index = TRY(outputNamed(programme.site, request.output));
    const show::Output& output = programme.site.outputs[index];

    Film film;
    film.size_ = request.size.value_or(output.size());
    if (request.canvas) {
        const double canvas = output.projection.canvasAspect;
        const auto aspect = canvas > 0 ? std::optional(canvas) : aspectOf(programme.sources);
        if (aspect && !request.size) film.size_ = sizeOfCanvas(kCanvasRows, *aspect);
        film.screen_ = TRY(OffScreen::open(film.size_, programme.sources));
    } else {
        if (!isSameShape(shapeOf(film.size_), shapeOf(output.size())))
            log::warning("app", fmt::format("the picture of '{}' is {:.2f} : 1 and is stretched to {:.2f} : 1, as --size says",
                                            request.output, shapeOf(output.size()), shapeOf(film.size_)));
        const show::Site scaled = programme.site.scaled(glm::dvec2(film.size_) / glm::dvec2(output.size()));
        film.screen_ = TRY(OffScreen::open(scaled.outputs[index].projection, blendOf(scaled, index), programme.sources));
    }
    film.frameRate_ = request.frameRate.value_or(output.refreshRate);

    show::CueList cues = *programme.cues;
    film.seconds_ = request.seconds.value_or(kShowSeconds);
    if (!request.cue.empty()) {  // it is entered at once and nothing follows it
        show::CueList::Cue& cue = cues.cues[static_cast<std::size_t>(programme.firstInput->cue)];
        programme.firstInput->at = -cue.length();
        cue.follow.reset();
        if (const double loop = loopOf(programme.sources); !request.seconds && loop > 0) film.seconds_ = loop;
    }
    GoSchedule schedule = goScheduleOf(programme, programme.firstCue(), fromSeconds(film.seconds_));
    if (!request.cue.empty()) schedule.end();
    const auto played = std::make_shared<ShowFrames>(std::move(cues), programme.firstInput, schedule);
    film.seenAt_ = [played, index](Time time) {
        const show::ShowState& state = played->at(time);
        return Seen{state.outputs[index], state.winds[index]};
    };
    return film;
}

}  // namespace fantascope::app
