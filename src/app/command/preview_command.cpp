#include "app/base/frame_run.h"
#include "app/base/geometry_options.h"
#include "app/base/video_writer.h"
#include "app/command/commands.h"
#include "app/export/film.h"
#include "app/export/light_preview.h"

#include "core/parallel.h"

#include <fmt/format.h>

#include <cmath>

namespace fantascope::app {
namespace {

namespace fs = std::filesystem;

constexpr double kFilmSeconds = 10, kFilmRate = 30;  // of a film without --seconds; frames per second

struct Options {
    FilmRequest mask;
    fs::path scene, file;
    std::optional<double> seconds, fieldOfView;
    std::optional<glm::ivec2> size;
    PreviewPlaces places;
    bool zUp = false;
    int threads = hardwareThreads();
};

void declare(Command& command, Options& options) {
    command
        .add("PATTERN", options.mask.what,
             "A *.pattern.yaml; a picture, such as the guide itself; or a show's folder, with --output and --cue")
        .required();
    command.add("--scene", options.scene, "The mesh to project on: FBX, OBJ, glTF, PLY or STL").required();
    declareFilmOptions(command, options.mask);
    addOutOption(command, options.file, "What to write: FILE.png, a picture, or FILE.mp4, a film of the movement").required();
    command
        .add("--seconds", options.seconds,
             fmt::format("For a picture: the moment of the movement (default: 0); for a film: its length (default: {})",
                         kFilmSeconds))
        .range(0.0, 1e6);
    const std::string unit = ", in the mesh's unit, y up ";
    addPointOption(
        command, "--projector", options.places.projector,
        "Where the projector stands" + unit + "(default: in front, upper left); put it far away to see the mesh in sunlight");
    addPointOption(command, "--look-at", options.places.lookAt, "Where the projector looks (default: the scene's middle)");
    command
        .add("--throw", options.places.throwRatio,
             "The projector's distance / picture width (default: the picture just contains the scene)")
        .range(0.01, 1e5);
    addPointOption(command, "--viewer", options.places.viewer, "Where the viewer stands" + unit + "(default: in front)");
    addPointOption(command, "--viewer-look-at", options.places.viewerLookAt,
                   "Where the viewer looks (default: the scene's middle)");
    command.add("--field-of-view", options.fieldOfView, "The viewer's horizontal field of view, degrees (default: 35)")
        .range(1.0, 150.0);
    command.add("--ambient", options.places.ambient, "Other light, as a share of the projector's white")
        .range(0.0, 100.0)
        .showDefault();
    command.addFlag("--ground", options.places.ground, "Add a floor under the scene");
    command.addFlag("--z-up", options.zUp,
                    "The mesh has z up; it is turned to y up, and the other options' points are given after that");
    addSizeOption(command, "--size", options.size, "Size of the picture (default: 1280x720)");
    command.add("--threads", options.threads, "Number of threads; does not change the picture").range(1, 256);
}

// The frames for the projector; their times rise from call to call.
struct Mask {
    std::optional<Film> film;                  // nothing: a still picture
    std::shared_ptr<const RgbaImage> picture;  // the still picture

    static Result<Mask> open(const FilmRequest& request) {
        if (fs::is_regular_file(request.what) && request.what.extension() != ".yaml") {
            auto picture = std::make_shared<const RgbaImage>(TRY(readRgba(request.what)));
            return Mask{std::nullopt, std::move(picture)};
        }
        if (!request.output.empty() && request.cue.empty())
            return Error(fmt::format("{}: a show needs a cue; add --cue NAME", request.what.string()));
        return Mask{TRY(Film::open(request)), nullptr};
    }
    glm::ivec2 size() const { return film ? film->size() : glm::ivec2(picture->width(), picture->height()); }
    std::shared_ptr<const RgbaImage> at(Time time) { return film ? std::make_shared<const RgbaImage>(film->at(time)) : picture; }
};

Result<void> run(const Options& options) {
    const bool film = options.file.extension() == ".mp4";
    if (!film && options.file.extension() != ".png")
        return Error(
            fmt::format("{}: a preview must be FILE.png, or FILE.mp4 for a film of the movement", options.file.string()));
    TriangleMesh mesh = TRY(readMesh(options.scene));
    if (options.zUp)
        for (glm::vec3& vertex : mesh.vertices) vertex = {vertex.x, vertex.z, -vertex.y};
    FilmRequest request = options.mask;
    request.canvas = true;  // the warp is for the site's own surface, not for this scene
    Mask mask = TRY(Mask::open(request));
    PreviewPlaces places = options.places;
    if (options.fieldOfView) places.fieldOfView = radians(*options.fieldOfView);
    const glm::ivec2 size = options.size.value_or(glm::ivec2(1280, 720)), maskSize = mask.size();
    if (std::min(maskSize.x, maskSize.y) < site::ProjectedLight::kMinSide)
        return Error(fmt::format("{}: a picture of {} x {} pixels cannot be projected", options.mask.what.string(), maskSize.x,
                                 maskSize.y));
    LightPreview preview = TRY(LightPreview::create(std::move(mesh), places, maskSize, size,
                                                    film ? LightPreview::Use::Film : LightPreview::Use::Still, options.threads)
                                   .in(options.scene.string()));
    if (!film) {
        TRY(writePng(options.file, preview.draw(mask.at(fromSeconds(options.seconds.value_or(0))))));
        fmt::print("{}: {} x {}\n", options.file.string(), size.x, size.y);
        return {};
    }
    const auto frames = std::max<std::int64_t>(1, std::llround(options.seconds.value_or(kFilmSeconds) * kFilmRate));
    const auto writer = TRY(VideoWriter::open(options.file, size, kFilmRate, VideoKind::Film));
    const std::int64_t made = TRY(makeFrames("preview", frames, [&](std::int64_t number) {
        return writer->write(preview.draw(mask.at(tickTime(number, kFilmRate))), number);
    }));
    if (made > 0) TRY(writer->finish());
    fmt::print("{}: {} x {}, {}\n", options.file.string(), size.x, size.y, outcomeOf(made, frames, kFilmRate));
    return {};
}

}  // namespace

void addPreviewCommand(Program& program) {
    addCommand<Options>(program, "preview", "Show a pattern as a light mask on a 3D scene", declare, run);
}

}  // namespace fantascope::app
