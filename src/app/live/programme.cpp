#include "app/live/programme.h"

#include "app/site/site_file.h"
#include "app/site/site_models.h"

#include "pattern/shape/shape_pattern.h"
#include "render/source/penumbra.h"
#include "theatre/energy/pose_problem.h"
#include "theatre/motion/moving_cast.h"
#include "theatre/motion/wanted_shadow.h"
#include "theatre/stage/cast.h"

#include "core/config/naming.h"
#include "core/log.h"
#include "media/image.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace fantascope::app {
namespace {

namespace fs = std::filesystem;

// The pictures of a show's sources, and for each source its guide, if it has one.
struct Pictures {
    render::PictureSources sources;
    show::BySource<std::optional<Guide>> guides;
};

struct Picture {
    render::PictureSource source;
    std::optional<Guide> guide;
};

// The options for reading sources.
struct Reading {
    render::VideoStream::Pace pace;
    const std::shared_ptr<render::PictureFeed>& camera;  // null: the site has none
    bool isWatched = false;                              // the camera's pictures are compared with the guides
};

Result<Picture> readPicture(const show::PatternSource& source, const Reading& reading) {
    render::PatternSource pattern = TRY(readPatternSource(source.file));
    std::optional<Guide> guide;
    if (reading.isWatched) guide = TRY(readGuide(*pattern.pattern, source.file));
    return Picture{std::move(pattern), std::move(guide)};
}

Result<Picture> readPicture(const show::SolidSource& source, const Reading&) { return Picture{source, {}}; }

// Reads a picture of what a small hole projects, as linear light.
Result<std::shared_ptr<const GreyImage>> readFilter(const fs::path& file) {
    GreyImage picture = TRY(readGrey(file));
    for (float& value : picture.pixels()) value = linearFromSrgb(value);
    if (std::all_of(picture.pixels().begin(), picture.pixels().end(), [](float light) { return light == 0; }))
        return Error(file.string() + ": a filter must not be all black");
    return std::make_shared<const GreyImage>(std::move(picture));
}

Result<Picture> readPicture(const show::FoliageSource& source, const Reading& reading) {
    render::FoliageSource foliage{source.light, source.shadow, {}};
    std::optional<Guide> guide;
    for (const show::FoliageSource::Layer& layer : source.layers) {
        render::ShadowLayer shadow;
        shadow.leaves = TRY(readPatternSource(layer.pattern));
        shadow.holes = layer.holes;
        shadow.filter.width = render::penumbraWidth(layer.distance, source.sun) / source.height;
        if (layer.filter) shadow.filter.picture = TRY(readFilter(*layer.filter));
        if (reading.isWatched && !guide) {
            guide = TRY(readGuide(*shadow.leaves.pattern, layer.pattern));
            if (!layer.holes) {
                guide->drawing = inverted(std::move(guide->drawing));
                guide->light = inverted(std::move(guide->light));
            }
        }
        const double aspect = (foliage.layers.empty() ? shadow : foliage.layers[0]).leaves.pattern->aspect();
        if (std::abs(shadow.leaves.pattern->aspect() - aspect) > 1e-6)
            return Error(
                fmt::format("{}: its picture is {:.4f} times as wide as high, and {} is {:.4f} times; the layers of one "
                            "foliage need drawings of one shape",
                            layer.pattern.string(), shadow.leaves.pattern->aspect(), source.layers[0].pattern.string(), aspect));
        foliage.layers.push_back(std::move(shadow));
    }
    return Picture{std::move(foliage), std::move(guide)};
}

Result<Picture> readPicture(const show::CausticsSource& source, const Reading&) { return Picture{source, {}}; }

Result<Picture> readPicture(const show::MirrorBallSource& source, const Reading&) { return Picture{source, {}}; }

Result<Picture> readPicture(const show::ImageSource& source, const Reading&) {
    return Picture{render::ImageSource{std::make_shared<const RgbaImage>(TRY(readRgba(source.file)))}, {}};
}

Result<Picture> readPicture(const show::VideoSource& source, const Reading& reading) {
    auto stream = TRY(render::VideoStream::open(source.file, reading.pace, source.from));
    if (const Time length = stream->content().length; source.to && *source.to > length)
        return Error(fmt::format("{}: it is {:.3f} s long, so it cannot play to {:.3f} s", source.file.string(), seconds(length),
                                 seconds(*source.to)));
    return Picture{render::VideoSource{std::move(stream), source.from, source.to, source.times, source.endsDark, source.speed},
                   {}};
}

Result<Picture> readPicture(const show::CameraSource&, const Reading& reading) {
    if (reading.camera == nullptr)
        return Error("the site has no camera; take this source out, or declare a 'camera' in the site file");
    return Picture{render::CameraSource{reading.camera}, {}};
}

Result<render::ShadowSource::Play> playOf(const show::ShadowSource& source, const theatre::Cast& cast) {
    using Asked = show::ShadowSource::Play;
    using Play = render::ShadowSource::Play;
    const bool loops = TRY(theatre::loops(cast));
    if (!source.play) return loops ? Play::Loop : Play::Once;
    if (*source.play == Asked::Loop && !loops)
        return Error(
            fmt::format("{}: its last frame does not lead to its first: as a loop it would jump; take 'to_and_fro', or a "
                        "silhouette that moves in a loop",
                        source.cast.string()));
    return *source.play == Asked::Loop ? Play::Loop : *source.play == Asked::Once ? Play::Once : Play::ToAndFro;
}

Result<Picture> readPicture(const show::ShadowSource& source, const Reading&) {
    constexpr int kRows = 64;  // a low resolution is enough, because nothing is compared here
    auto cast = std::make_shared<const theatre::Cast>(TRY(theatre::readCast(source.cast)));
    render::ShadowSource shadow;
    shadow.cast = cast;
    shadow.samples = source.samples;
    shadow.play = TRY(playOf(source, *cast));
    shadow.speed = source.speed;
    if (static_cast<std::size_t>(source.beam) > cast->stage.beams.size())
        return Error(
            fmt::format("'beam' is {}, but the stage of {} has {}", source.beam, source.cast.string(), cast->stage.beams.size()));
    shadow.beam = static_cast<std::size_t>(source.beam - 1);
    const glm::dvec3 light = cast->stage.beams[shadow.beam].light;
    for (const show::ShadowSource::Lamp& lamp : source.lamps) {
        const glm::dvec3 place = lamp.at.value_or(light);
        if (cast->stage.screenOf(shadow.beam).screenFromStage(place).z <= 0)
            return Error(
                fmt::format("the lamp at [{}, {}, {}] is not in front of the screen that it lights", place.x, place.y, place.z));
        if (!lamp.actors.empty() && lamp.actors.size() != cast->actors.size())
            return Error(fmt::format("{} colours of 'actors', but {} has {}; give one for each, in its order", lamp.actors.size(),
                                     source.cast.string(), cast->actors.size()));
        shadow.lamps.push_back(
            {place, lamp.size, lamp.light, lamp.shadow, std::vector<glm::vec3>(lamp.actors.begin(), lamp.actors.end())});
    }
    if (source.picture) {
        shadow.from = {source.picture->x.x, source.picture->y.x};
        shadow.to = {source.picture->x.y, source.picture->y.y};
        return Picture{std::move(shadow), {}};
    }
    if (shadow.beam >= cast->targets.size())
        return Error(fmt::format("{} has no target for beam {}; give the part of its screen by 'picture'", source.cast.string(),
                                 source.beam));
    const theatre::Cast::Target& wanted = cast->targets[shadow.beam];
    auto read = readGrey(wanted.file);
    if (!read) return namedIn(source.cast, wanted.file, read.error());
    GreyImage drawing = std::move(*read);
    auto target = theatre::PoseTarget::from(drawing, cast->stage, wanted.height, kRows, {shadow.beam, wanted.middle});
    if (!target) return target.error().in(wanted.file.string());
    const theatre::ScreenFrame& given = target->given;
    shadow.from = given.metresAt({0, given.height()});
    shadow.to = given.metresAt({given.width(), 0});
    std::optional<Guide> guide;
    // On a white screen, a shadow that does not move looks like the negative of its drawing.
    if (cast->actors.front().poses.size() == 1) {
        drawing = inverted(std::move(drawing));
        guide = Guide{drawing, drawing, static_cast<double>(given.width()) / given.height()};
    }
    return Picture{std::move(shadow), std::move(guide)};
}

Result<Picture> readSource(const show::Source& source, const Reading& reading) {
    auto made = std::visit([&](const auto& kind) { return readPicture(kind, reading); }, source.picture);
    if (!made) return source.at.error(made.error());
    made->source.fit = source.fit;
    if (made->guide) made->guide->fit = source.fit;
    return made;
}

Result<Pictures> readPictures(const show::Show& show, const Reading& reading) {
    Pictures pictures;
    ConfigFaults faults;
    for (const show::Source& source : show.sources)
        faults.take(readSource(source, reading), [&](Picture picture) {
            pictures.sources.add(source.id, std::move(picture.source));
            pictures.guides.add(source.id, std::move(picture.guide));
        });
    TRY(faults.result());
    return pictures;
}

Result<std::vector<Watch::Comparisons>> compareWith(const show::BySource<std::optional<Guide>>& guides, const show::Site& site,
                                                    const std::vector<LightCorrection>& light) {
    const auto gains = gainsToApply(site, light);
    std::vector<Watch::Comparisons> comparisons(site.outputs.size());
    for (std::size_t output = 0; output < site.outputs.size(); ++output)
        for (const auto& [source, guide] : guides) {
            if (!guide) continue;
            if (auto comparison = TRY(comparisonWith(*guide, site, output, gains[output] != nullptr)))
                comparisons[output].guides.add(source, std::make_shared<const vision::GuideComparison>(std::move(*comparison)));
        }
    return comparisons;
}

// By how much a place that the target wants dark loses light: that of the lamps at the beam's
// light, or of all lamps if none is there. 0: there is no one such loss, because each actor's
// shadow has a colour of its own.
glm::dvec3 lostLight(const render::ShadowSource& source) {
    constexpr double kThere = 0.01;  // metres
    glm::dvec3 there(0), all(0);
    for (const render::ShadowSource::Lamp& lamp : source.lamps) {
        if (!lamp.actors.empty()) return glm::dvec3(0);
        const glm::dvec3 lost = lamp.light - lamp.shadow;
        all += lost;
        if (glm::distance(lamp.place, source.cast->stage.beams[source.beam].light) < kThere) there += lost;
    }
    return there != glm::dvec3(0) ? there : all;
}

// Adds a shadow's comparison to each output that the camera can watch. A target that cannot be read
// is no reason to keep the show from running.
Result<void> compareShadow(const show::Source& source, const render::PictureSource& picture, const show::Site& site,
                           const std::vector<LightCorrection>& light, std::vector<Watch::Comparisons>& comparisons) {
    const auto& shadow = std::get<render::ShadowSource>(picture.picture);
    const glm::dvec3 lost = lostLight(shadow);
    if (lost == glm::dvec3(0)) return {};
    auto wanted = theatre::wantedShadow(*shadow.cast, shadow.beam, shadow.from, shadow.to, vision::ShadowComparison::kRows);
    if (!wanted) {
        log::warning("app", fmt::format("the shadow of '{}' is not scored: {}", source.name, wanted.error().message()));
        return {};
    }
    const auto shared = std::make_shared<const theatre::WantedShadow>(std::move(*wanted));
    const auto gains = gainsToApply(site, light);
    for (std::size_t output = 0; output < site.outputs.size(); ++output) {
        auto view = TRY(nominalViewOf(site, output, *render::aspectOf(picture), picture.fit));
        if (!view) continue;
        view->isEvenedOut = gains[output] != nullptr;
        comparisons[output].shadows.add(
            source.id, {shadow, shared, std::make_shared<const vision::ShadowComparison>(*view, lost, shared->counted)});
    }
    return {};
}

// The outputs that show a source in any cue.
std::set<std::size_t> outputsOf(show::SourceId source, const show::CueList& cues) {
    std::set<std::size_t> outputs;
    for (const auto& side : cues.sides) outputs.merge(outputsOf(source, *side));
    for (const show::CueList::Cue& cue : cues.cues)
        for (std::size_t output = 0; output < cue.look.outputs.size(); ++output)
            if (std::ranges::any_of(cue.look.outputs[output].layers,
                                    [&](const show::LayerState& layer) { return layer.source == source; }))
                outputs.insert(output);
    return outputs;
}

// Takes the projectors' fall-off by the plan out of a surface: the eye forgives it, and the scores
// do too, as long as the light is not evened out.
Result<void> forgiveFallOff(vision::CanvasSurface& surface, const Programme& programme, const Guide& guide) {
    const auto gains = gainsToApply(programme.site, programme.light);
    for (vision::CanvasSurface::Part& part : surface.parts) {
        const auto view = TRY(nominalViewOf(programme.site, part.output, guide.aspect, guide.fit));
        if (!view || gains[part.output] != nullptr) continue;
        const auto strengthAt = [&](glm::dvec2 pixel) {
            const auto point = view->surface.hitBy(view->projector.rayThrough(pixel));
            return point ? view->projector.pixelsPerArea(*point, view->surface.normal) : 0.0;
        };
        const double middle = strengthAt(glm::dvec2(programme.site.outputs[part.output].size()) / 2.0);
        for (std::size_t i = 0; middle > 0 && i < part.light.pixels().size(); ++i)
            if (const double strength = part.light.pixels()[i] > 0 ? strengthAt(part.pixel.pixels()[i]) : 0; strength > 0)
                part.light.pixels()[i] *= static_cast<float>(middle / strength);
    }
    return {};
}

// A pattern and its wall. Error: why it cannot be fitted.
Result<PatternOnWall> onWall(const show::Source& source, const render::PatternSource& drawn, const Guide& guide,
                             const Programme& programme) {
    constexpr int kRows = 360;  // the camera sees no finer
    const show::Site& site = programme.site;
    const std::set<std::size_t> outputs = outputsOf(source.id, *programme.cues);
    if (drawn.pattern->instances.empty() || outputs.empty()) return Error("nothing of it is shown");
    if (drawn.pattern->compare != pattern::CompareSpace::Light)
        return Error("it was not compared in light; search for it with 'compare: light' in the settings");
    for (const std::size_t output : outputs) {
        if (site.outputs[output].canvas != site.outputs[*outputs.begin()].canvas) return Error("it is shown on several canvases");
        if (!programme.watched.at(output) || !programme.watched[output]->isSurveyed)
            return Error(fmt::format("output '{}' was not surveyed; 'fantascope calibrate {} --write' does that",
                                     site.outputs[output].name, site.file.string()));
    }
    const double aspect = guide.aspect;
    vision::CanvasSurface surface = TRY(canvasSurface(site, *outputs.begin(), aspect, guide.fit,
                                                      {std::max(1, static_cast<int>(std::lround(kRows * aspect))), kRows}));
    std::erase_if(surface.parts, [&](const vision::CanvasSurface::Part& part) { return !outputs.contains(part.output); });
    TRY(forgiveFallOff(surface, programme, guide));
    return PatternOnWall{source.id, source.name, drawn.pattern, guide.light, std::move(surface)};
}

std::vector<PatternOnWall> patternsOnWall(const Programme& programme, const show::BySource<std::optional<Guide>>& guides) {
    using Mode = show::Corrections::Mode;
    std::vector<PatternOnWall> patterns;
    const Mode mode = programme.site.corrections.pattern.mode;
    if (mode == Mode::Off || programme.watched.empty()) return patterns;
    for (const show::Source& source : programme.show.sources) {
        const auto* const drawn = std::get_if<render::PatternSource>(&programme.sources.find(source.id)->picture);
        const auto* const guide = guides.find(source.id);
        if (drawn == nullptr || guide == nullptr || !*guide) continue;
        auto pattern = onWall(source, *drawn, **guide, programme);
        if (pattern)
            patterns.push_back(std::move(*pattern));
        else if (mode == Mode::Automatic)
            log::warning(
                "app", fmt::format("the pattern of '{}' is not fitted to the wall: {}", source.name, pattern.error().message()));
    }
    return patterns;
}

}  // namespace

Result<Guide> readGuide(const pattern::ShapePattern& pattern, const fs::path& file) {
    auto drawing = readGrey(pattern.guide);
    if (!drawing) return namedIn(file, pattern.guide, drawing.error());
    GreyImage light = comparedGuide(*drawing, pattern.guideTransfer, pattern::CompareSpace::Light);
    return Guide{comparedGuide(std::move(*drawing), pattern.guideTransfer, pattern.compare), std::move(light), pattern.aspect()};
}

Result<std::optional<vision::GuideComparison>> comparisonWith(const Guide& guide, const show::Site& site, std::size_t output,
                                                              bool isEvenedOut) {
    auto view = TRY(nominalViewOf(site, output, guide.aspect, guide.fit));
    if (!view) return std::optional<vision::GuideComparison>();
    view->isEvenedOut = isEvenedOut;
    return std::optional(vision::GuideComparison(*view, guide.drawing, guide.light));
}

Result<render::PatternSource> readPatternSource(const fs::path& file) {
    auto pattern = std::make_shared<const pattern::ShapePattern>(TRY(pattern::readPattern(file)));
    auto motion = std::make_shared<const pattern::PatternMotion>(*pattern);
    return render::PatternSource{std::move(pattern), std::move(motion)};
}

Result<render::PictureSource> readPictureSource(const show::Source& source, render::VideoStream::Pace pace,
                                                const std::shared_ptr<render::PictureFeed>& camera) {
    return TRY(readSource(source, {pace, camera})).source;
}

void addVideos(const Programme& programme, RunReport& report) {
    for (const show::Source& source : programme.show.sources)
        if (const auto* video = std::get_if<render::VideoSource>(&programme.sources.find(source.id)->picture)) {
            report.lateVideoFrames[source.name] = video->stream->lateFrames();
            report.damagedVideoFrames[source.name] = video->stream->damagedFrames();
        }
}

GoSchedule goScheduleOf(const Programme& programme, std::optional<std::size_t> first, Time length) {
    const show::Show& show = programme.show;
    if (show.schedule) return {0, first.has_value(), length};
    if (!first) return {show.cues.size(), false, length};
    const bool playsByItself = show.start && show.needsNoGoFrom(*first);
    return {playsByItself ? 0 : show.cues.size() - *first - 1, true, length};
}

// When a run's wall clock begins, UTC; nothing: it is the machine's. A rehearsal of a schedule
// begins as the next night does.
Result<std::optional<Time>> wallFrom(const RunOptions& options, const Programme& programme) {
    const show::Nights* const nights = programme.nights();
    if (options.at) {
        if (nights == nullptr)
            return Error(fmt::format("{}: the show has no schedule, so --at changes nothing", programme.show.file.string()));
        return std::optional(nights->zone().utcOf(options.at->date, options.at->timeOfDay));
    }
    if (nights != nullptr && options.backends != Backends::AsDeclared) {
        const auto night =
            nights->nextFrom(programme.show.schedule->first.value_or(nights->nightAt(SystemWallClock().now().utc)));
        if (!night) return programme.show.schedule->at.error("nothing plays within a year; 'fantascope schedule' says why");
        return std::optional(night->moments.front().utc);
    }
    return options.asFastAsPossible ? std::optional(Time{}) : std::nullopt;
}

ShowReload::Files Programme::files(std::function<void(std::vector<Projection>)> adopt) const {
    return {[this](const show::Source& source) { return readPictureSource(source, render::VideoStream::Pace::Live, camera); },
            readSite, std::move(adopt)};
}

Result<Programme> readProgramme(const RunOptions& options) {
    show::SourceNames names;
    show::Show show = TRY(show::Show::load(options.show, names));
    show::Site site = TRY(readSite(options.site));
    std::shared_ptr<render::PictureFeed> camera;
    if (site.nominalCamera) camera = std::make_shared<render::PictureFeed>(site.nominalCamera->size);
    using Pace = render::VideoStream::Pace;
    const bool isWatched = site.camera && std::ranges::any_of(site.outputs, [](const show::Output& output) {
                               return output.projector && output.surface;
                           });
    Pictures pictures = TRY(readPictures(show, {options.asFastAsPossible ? Pace::Exact : Pace::Live, camera, isWatched}));
    const show::PlayLengths lengths = render::playLengthsOf(pictures.sources);
    Programme programme(TRY(show::Revision::of(std::move(show), std::move(site), &lengths)));
    programme.names = std::move(names);
    programme.sources = std::move(pictures.sources);
    programme.camera = std::move(camera);
    std::optional<std::size_t> first = programme.show.start;
    if (!options.fromCue.empty()) first = TRY(programme.show.cueNamed(options.fromCue));
    if (first) programme.firstInput = show::Input{Time{}, show::Input::Kind::Jump, static_cast<int>(*first)};
    programme.wallFrom = TRY(wallFrom(options, programme));
    programme.light = lightCorrectionsOf(programme.site);
    programme.comparisons = TRY(compareWith(pictures.guides, programme.site, programme.light));
    for (const show::Source& source : programme.show.sources)
        if (const auto* const picture = programme.sources.find(source.id);
            isWatched && std::holds_alternative<render::ShadowSource>(picture->picture))
            TRY(compareShadow(source, *picture, programme.site, programme.light, programme.comparisons));
    programme.watched = TRY(watchedOutputsOf(programme.site));
    programme.patterns = patternsOnWall(programme, pictures.guides);
    return programme;
}

}  // namespace fantascope::app
