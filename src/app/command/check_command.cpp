#include "app/command/check_command.h"

#include "app/base/drawing.h"
#include "app/base/silhouette_file.h"
#include "app/calibrate/wanted_file.h"
#include "app/check/oddities.h"
#include "app/command/commands.h"
#include "app/lens/lens_file.h"
#include "app/live/programme.h"
#include "app/site/site_file.h"
#include "app/site/survey_file.h"

#include "pattern/search/pattern_settings.h"
#include "pattern/shape/elemental_shape.h"
#include "pattern/shape/shape_pattern.h"
#include "render/source/video_stream.h"
#include "show/show.h"
#include "show/site/site.h"
#include "theatre/deform/handle_motion.h"
#include "theatre/deform/silhouette_sequence.h"
#include "theatre/energy/pose_hints.h"
#include "theatre/energy/pose_problem.h"
#include "theatre/energy/weights_file.h"
#include "theatre/stage/cast.h"
#include "theatre/stage/stage_file.h"

#include "core/config/config.h"
#include "core/config/naming.h"
#include "core/file.h"
#include "core/text.h"
#include "media/image.h"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <iostream>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>

namespace fantascope::app {
namespace {

namespace fs = std::filesystem;

// What is known of a valid file.
struct Finding {
    std::string summary;
    std::vector<fs::path> names{};        // the files that it names
    std::vector<std::string> oddities{};  // valid, but perhaps not what was meant; each with its place
    bool isPicture = false;               // its oddities are not reported if another file names it
};

// "1 cue", "6 cues".
std::string counted(std::size_t count, std::string_view thing) {
    return fmt::format("{} {}{}", count, thing, count == 1 ? "" : "s");
}

Result<Finding> checkFile(const fs::path& path, const std::optional<show::Site>& site);

// The rows of a picture's pixels; 0: it has none.
double rowsOf(const render::PictureSource& source) {
    if (const auto* const image = std::get_if<render::ImageSource>(&source.picture)) return image->picture->height();
    if (const auto* const video = std::get_if<render::VideoSource>(&source.picture)) return video->stream->content().size.y;
    return 0;
}

Result<Finding> checkShow(const fs::path& path, const std::optional<show::Site>& site) {
    const show::Show show = TRY(show::Show::load(path));
    Finding finding{fmt::format("show, {}, {}, {}, {}", counted(show.cues.size(), "cue"), counted(show.looks.size(), "look"),
                                counted(show.sources.size(), "source"), show.beginning())};
    ConfigFaults faults;
    show::CueList cues;
    std::optional<show::Nights> nights;
    if (site) faults.take(show::nightsOf(show, *site), [&](auto planned) { nights = std::move(planned); });
    if (nights) noteNights(show, *nights, finding.oddities);
    std::shared_ptr<render::PictureFeed> camera;
    if (site && site->nominalCamera) camera = std::make_shared<render::PictureFeed>(site->nominalCamera->size);
    show::BySource<ShapedSource> shaped;
    render::PictureSources sources;
    for (const show::Source& source : show.sources) {
        noteNegatives(source, finding.oddities);
        const std::vector<fs::path> files = show::filesOf(source);
        finding.names.insert(finding.names.end(), files.begin(), files.end());
        if (std::holds_alternative<show::CameraSource>(source.picture) && !camera) {
            if (site) faults.add(source.at.error(fmt::format("{} has no camera", site->file.string())));
            continue;
        }
        const auto read = readPictureSource(source, render::VideoStream::Pace::Exact, camera);
        if (read) {
            if (const auto aspect = render::aspectOf(*read)) shaped.add(source.id, {&source, *aspect, rowsOf(*read)});
            sources.add(source.id, *read);
        } else if (std::all_of(files.begin(), files.end(),
                               [&](const fs::path& file) { return checkFile(file, site).has_value(); })) {
            faults.add(read.error());  // each file is valid, but they do not fit together
        }
    }
    const show::PlayLengths lengths = render::playLengthsOf(sources);
    const bool isWhole = sources.size() == show.sources.size();
    if (site) faults.take(show.bind(*site, isWhole ? &lengths : nullptr), [&](show::CueList bound) { cues = std::move(bound); });
    TRY(faults.result());
    noteUnseen(show, finding.oddities);
    if (site) {
        noteShapes(cues, shaped, *site, finding.oddities);
        noteUnnamed(show, *site, finding.oddities);
        noteLists(show, *site, finding.oddities);
        finding.summary += fmt::format(", plays on {}", site->file.string());
    }
    return finding;
}

Result<Finding> checkSite(const fs::path& path, const std::optional<show::Site>&) {
    const show::Site site = TRY(readSite(path));
    Finding finding{fmt::format("site, {}, {}, {}{}", counted(site.outputs.size(), "output"),
                                counted(site.fixtures.size(), "fixture"), counted(site.relays.size(), "relay"),
                                site.camera ? ", camera" : "")};
    noteSimulated(site, finding.oddities);
    noteGaps(site, finding.oddities);
    std::error_code ignored;
    if (const fs::path survey = surveyFileOf(site.file); fs::exists(survey, ignored)) finding.names.push_back(survey);
    return finding;
}

Result<Finding> checkPattern(const fs::path& path, const std::optional<show::Site>& site) {
    const pattern::ShapePattern pattern = TRY(pattern::readPattern(path));
    Finding finding{fmt::format("pattern, {}, {}", counted(pattern.instances.size(), "instance"),
                                counted(pattern.triangleCount(), "triangle"))};
    std::error_code ignored;
    const bool isWatched = !site || site->camera;  // by a camera that compares the wall with the drawing
    if (isWatched || fs::exists(pattern.guide, ignored))
        finding.names.push_back(pattern.guide);
    else
        finding.oddities.push_back(
            namedIn(path, pattern.guide,
                    Error(fmt::format("{}: is missing; without a camera the show plays all the same", pattern.guide.string())))
                .message());
    return finding;
}

Result<Finding> checkPatternSettings(const fs::path& path, const std::optional<show::Site>&) {
    const pattern::PatternSettings settings = TRY(pattern::readPatternSettings(path));
    const std::string shapes = settings.shapes.empty() ? "" : ", " + counted(settings.shapes.size(), "shape");
    return Finding{fmt::format("pattern settings, at most {}{}", counted(settings.search.instances, "instance"), shapes), {}};
}

Result<Finding> checkWanted(const fs::path& path, const std::optional<show::Site>&) {
    const WantedCorners wanted = TRY(readWanted(path));
    return Finding{fmt::format("wanted places, {}", counted(wanted.size(), "output")), {}};
}

Result<Finding> checkLens(const fs::path& path, const std::optional<show::Site>&) {
    const KeptLens lens = TRY(readLens(path));
    return Finding{fmt::format("lens of {}, {} x {} pixels", lens.camera(), lens.size.x, lens.size.y), {}};
}

Result<Finding> checkSurveyFile(const fs::path& path, const std::optional<show::Site>&) {
    return Finding{fmt::format("survey, {}", counted(TRY(checkSurvey(path)).size(), "output")), {}};
}

// The drawing of a motion or of hints: NAME.png for NAME.motion.yaml. If it is missing, an
// all-white one stands in, so that everything else can be checked.
struct Drawing {
    GreyImage picture;
    std::string note;  // what was not checked

    static Result<Drawing> beside(const fs::path& path) {
        const fs::path file = path.parent_path() / (path.stem().stem().string() + ".png");
        std::error_code ignored;
        if (fs::exists(file, ignored)) return Drawing{TRY(readSilhouette(file)), ""};
        constexpr int kSide = 512;
        GreyImage white(kSide, kSide);
        for (int y = 1; y + 1 < kSide; ++y)
            for (int x = 1; x + 1 < kSide; ++x) white.at(x, y) = 1;
        return Drawing{std::move(white),
                       fmt::format("; there is no {} to say whether its points are in the white", file.filename().string())};
    }
};

Result<Finding> checkMotion(const fs::path& path, const std::optional<show::Site>&) {
    using theatre::TriangulatedSilhouette;
    const Drawing drawing = TRY(Drawing::beside(path));
    const auto silhouette = TRY(TriangulatedSilhouette::of(drawing.picture, TriangulatedSilhouette::kVertices).in(path.string()));
    const theatre::HandleMotion motion = TRY(theatre::readMotion(path, silhouette));
    return Finding{fmt::format("motion, {}, {:g} s, {:g} frames a second{}{}", counted(motion.handles.size(), "handle"),
                               motion.seconds, motion.framesPerSecond, motion.loops ? ", loops" : "", drawing.note),
                   {}};
}

Result<Finding> checkSequence(const fs::path& path, const std::optional<show::Site>&) {
    const theatre::SilhouetteSequence sequence = TRY(theatre::readSequence(path));
    glm::ivec2 size(0);
    for (const fs::path& file : sequence.pictures) {
        const GreyImage picture = TRY(readSilhouette(file));
        size = {picture.width(), picture.height()};
    }
    return Finding{fmt::format("sequence, {}, {} x {} px, {:g} a second{}{}", counted(sequence.pictures.size(), "frame"), size.x,
                               size.y, sequence.framesPerSecond, sequence.loops ? ", loops" : "",
                               sequence.interior ? ", " + counted(sequence.interior->triangles.size(), "triangle") : ""),
                   {}};
}

Result<Finding> checkCast(const fs::path& path, const std::optional<show::Site>&) {
    const theatre::Cast cast = TRY(theatre::readCast(path));
    const std::size_t frames = cast.actors[0].poses.size();
    const std::string motion =
        cast.framesPerSecond > 0 ? fmt::format("{}, {:g} a second", counted(frames, "frame"), cast.framesPerSecond) : "still";
    Finding finding{
        fmt::format("cast, {}, {}, {:g} m high", counted(cast.actors.size(), "actor"), motion, cast.targets[0].height), {}};
    for (const theatre::Cast::Target& target : cast.targets) finding.names.push_back(target.file);
    if (cast.stageFile) finding.names.push_back(*cast.stageFile);
    if (cast.sequence) finding.names.push_back(cast.sequence->file);
    return finding;
}

Result<Finding> checkStage(const fs::path& path, const std::optional<show::Site>&) {
    const theatre::Stage stage = TRY(theatre::readStage(path));
    return Finding{fmt::format("stage, {}, {}, {}", stage.beams[0].lit ? "projector" : "light",
                               counted(stage.platforms.size(), "platform"), counted(stage.props.size(), "prop")),
                   {}};
}

// Uses NAME.stage.yaml, if there is one, for the props that the hints name.
Result<Finding> checkHints(const fs::path& path, const std::optional<show::Site>&) {
    const Drawing drawing = TRY(Drawing::beside(path));
    const fs::path file = path.parent_path() / (path.stem().stem().string() + ".stage.yaml");
    std::error_code ignored;
    theatre::Stage stage;
    if (fs::exists(file, ignored)) stage = TRY(theatre::readStage(file));
    constexpr int kRows = 128;
    const auto target = TRY(theatre::PoseTarget::from(drawing.picture, {}, 1, kRows).in(path.string()));
    const auto hints = TRY(theatre::readHints(path, target, stage));
    return Finding{fmt::format("hints, {}{}", counted(hints.size(), "point"), drawing.note), {}};
}

Result<Finding> checkWeights(const fs::path& path, const std::optional<show::Site>&) {
    TRY(theatre::readWeights(path));
    return Finding{"pose weights", {}};
}

Result<Finding> checkGuide(const fs::path& path) {
    const GreyImage guide = TRY(readGrey(path));
    Finding finding{fmt::format("guide, {} x {} px", guide.width(), guide.height())};
    finding.isPicture = true;
    if (isInkOnPaper(guide))
        finding.oddities.push_back(
            fmt::format("{}: looks like dark ink on white paper; as a guide or silhouette it needs --invert", path.string()));
    return finding;
}

Result<Finding> checkVideo(const fs::path& path) {
    const auto stream = TRY(render::VideoStream::open(path, render::VideoStream::Pace::Exact));
    const render::VideoContent& video = stream->content();
    return Finding{fmt::format("video, {} x {} px, {}, {:.2f} s, {}", video.size.x, video.size.y,
                               counted(video.frames.size(), "frame"), seconds(video.length), video.codec),
                   {}};
}

bool isVideoFile(const fs::path& path) {
    static const std::set<std::string> kEndings = {".mp4",  ".m4v", ".mov",  ".mkv", ".webm", ".avi", ".mpg",
                                                   ".mpeg", ".ts",  ".m2ts", ".mxf", ".ogv",  ".wmv"};
    return kEndings.contains(endingOf(path));
}

// A picture may be a shape or a guide; here it counts as a guide.
bool isShapeFile(const fs::path& path) {
    static const std::set<std::string> kEndings = {".svg", ".fbx", ".obj", ".gltf", ".glb", ".ply", ".stl"};
    return kEndings.contains(endingOf(path));
}

Result<Finding> checkShape(const fs::path& path) {
    const pattern::ElementalShape shape = TRY(pattern::readShapeFile(path, path.string()));
    return Finding{fmt::format("elemental shape, {}", counted(shape.mesh.triangles.size(), "triangle")), {}};
}

using Check = Result<Finding> (*)(const fs::path&, const std::optional<show::Site>&);

// A YAML file states its own kind.
constexpr std::pair<std::string_view, Check> kKinds[] = {{"show", checkShow},        {"site", checkSite},
                                                         {"pattern", checkPattern},  {"pattern-settings", checkPatternSettings},
                                                         {"motion", checkMotion},    {"sequence", checkSequence},
                                                         {"cast", checkCast},        {"stage", checkStage},
                                                         {"hints", checkHints},      {"pose-weights", checkWeights},
                                                         {"wanted", checkWanted},    {"lens", checkLens},
                                                         {"survey", checkSurveyFile}};

Result<Finding> checkYaml(const fs::path& path, const std::optional<show::Site>& site) {
    std::vector<std::string> names;
    for (const auto& kind : kKinds) names.emplace_back(kind.first);
    const ConfigNode root = TRY(ConfigNode::load(path));
    for (const auto& [key, value] : TRY(root.entries()))
        if (key == "fantascope") return kKinds[TRY(value.choice(names))].second(path, site);
    return root.error(fmt::format("'fantascope' is missing: the kind of file, one of {}", fmt::join(names, ", ")));
}

// The file that a folder stands for, or the file itself.
fs::path fileOf(const fs::path& path) {
    std::error_code ignored;
    if (!fs::is_directory(path, ignored)) return path;
    for (const char* name : {"sequence.yaml", "site.yaml"})
        if (fs::exists(path / name, ignored)) return path / name;
    return path / "show.yaml";
}

Result<Finding> checkFile(const fs::path& path, const std::optional<show::Site>& site) {
    std::error_code ignored;
    if (fs::is_directory(path, ignored)) {
        if (fs::exists(path / "sequence.yaml", ignored)) return checkSequence(path / "sequence.yaml", site);
        return fs::exists(path / "site.yaml", ignored) ? checkSite(path / "site.yaml", site) : checkShow(path, site);
    }
    if (path.extension() == ".yaml") return checkYaml(path, site);
    if (isVideoFile(path)) return checkVideo(path);
    return isShapeFile(path) ? checkShape(path) : checkGuide(path);
}

void declareOptions(Command& command, CheckOptions& options) {
    command
        .add("path", options.paths,
             "Folders of shows, sites and sequences; files of shows, sites and patterns; casts, stages, motions, hints and "
             "weights; guides and images, videos, shapes (SVG, meshes)")
        .required()
        .typeName("PATH");
    command.add("--site", options.site, "Look up the shows' outputs, fixtures and relays in this site: a folder or a site.yaml")
        .typeName("SITE");
}

Result<void> runCheck(const CheckOptions& options) { return checkFiles(options, std::cout); }

}  // namespace

Result<void> checkFiles(const CheckOptions& options, std::ostream& out) {
    std::deque<fs::path> waiting(options.paths.begin(), options.paths.end());
    std::optional<show::Site> site;
    if (options.site) {
        waiting.push_front(*options.site);
        if (auto read = readSite(*options.site)) site = std::move(read).value();  // its faults are reported in its turn
    }
    std::set<fs::path> seen, given;
    for (const fs::path& path : options.paths) given.insert(path.lexically_normal());
    std::map<fs::path, fs::path> namedBy;
    std::size_t refused = 0;
    for (; !waiting.empty(); waiting.pop_front()) {
        const fs::path path = waiting.front();
        if (!seen.insert(path.lexically_normal()).second) continue;
        const auto finding = checkFile(path, site);
        if (!finding) {
            const auto by = namedBy.find(path);
            out << printableLines((by == namedBy.end() ? finding.error() : namedIn(by->second, path, finding.error())).message())
                << "\n";
            ++refused;
            continue;
        }
        out << printableLines(fmt::format("ok {}: {}\n", path.string(), finding->summary));
        if (!finding->isPicture || given.contains(path.lexically_normal()))
            for (const std::string& oddity : finding->oddities) out << printableLines("   note: " + oddity) << "\n";
        for (const fs::path& name : finding->names) {
            waiting.push_back(name);
            namedBy.try_emplace(name, fileOf(path));
        }
    }
    if (refused > 0) return Error(fmt::format("{} of {} refused", refused, counted(seen.size(), "file")));
    return {};
}

void addCheckCommand(Program& program) {
    addCommand<CheckOptions>(program, "check", "Read files as the program would, and report what is wrong with them",
                             declareOptions, runCheck);
}

}  // namespace fantascope::app
