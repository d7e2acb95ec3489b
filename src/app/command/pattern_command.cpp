#include "app/base/attendance.h"
#include "app/base/drawing.h"
#include "app/base/output.h"
#include "app/base/progress.h"
#include "app/base/report.h"
#include "app/command/commands.h"
#include "app/command/pattern_surface.h"
#include "drivers/display/picture_window.h"

#include "pattern/search/measure.h"
#include "pattern/search/motion_fit.h"
#include "pattern/search/pattern_search.h"
#include "pattern/search/pattern_settings.h"
#include "pattern/shape/built_in_shapes.h"
#include "pattern/shape/elemental_shape.h"

#include "core/clock.h"
#include "core/file.h"
#include "core/log.h"
#include "core/parallel.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <limits>
#include <optional>
#include <set>
#include <vector>

namespace fantascope::app {
namespace {

namespace fs = std::filesystem;
using pattern::PatternSearch;
using pattern::ShapePattern;

constexpr double kDefaultSeconds = 30;
constexpr int kLoopMoments = 200;  // of the animated loop that are measured: one in ten of the default 2000 frames

struct Options {
    fs::path guide, output;
    std::vector<std::string> shapes;
    std::optional<fs::path> settings, image, report, start;
    std::optional<std::string> surface;  // SITE:OUTPUT
    std::vector<double> region;          // left, top, right, bottom; or empty
    std::optional<std::uint32_t> instances;
    std::optional<double> seconds, targetZ;
    std::optional<int> iterations;
    bool shadows = false, invert = false;
    std::uint64_t seed = 1;
    int threads = hardwareThreads();
    PatternSearch::Method method = PatternSearch::Method::Refined;
    bool watch = false;
};

void declare(Command& command, Options& options) {
    command.add("GUIDE", options.guide, "The grey drawing: PNG, JPEG or TIFF").required();
    addOutOption(command, options.output, "The pattern to write, P.pattern.yaml").required().check(onlyYaml("P.pattern.yaml"));
    command
        .add("--shapes", options.shapes,
             fmt::format("Elemental shapes, separated by commas: {}, or files (FBX, OBJ, glTF, PLY, STL, SVG, PNG) "
                         "(default: those of the settings, else triangle)",
                         pattern::builtInShapeList()))
        .delimiter(',')
        .noExtraArguments();
    command.add("--settings", options.settings, "The numerical parameters, *.pattern-settings.yaml");
    command.add("--instances", options.instances, "Maximum number of instances").range(1, 100'000);
    command
        .add("--seconds", options.seconds,
             fmt::format("Stop after so many seconds (default: {}, unless --iterations is given)", kDefaultSeconds))
        .range(0.0, 1e6);
    command.add("--iterations", options.iterations, "Stop after so many iterations; repeats a run exactly")
        .range(0, std::numeric_limits<int>::max());
    command.add("--target-z", options.targetZ, "Stop once the mean difference from the guide is below this").range(0.0, 1.0);
    command
        .addChoice<PatternSearch::Method>("--method", options.method,
                                          {{"refined", PatternSearch::Method::Refined}, {"paper", PatternSearch::Method::Paper}},
                                          "refined: one exact move at a time; paper: Ji et al. 2015, section 4.1, as written")
        .defaultText("refined");
    const Option start =
        command.add("--start", options.start, "Start from this pattern, with its shapes, seed and movement; refined method only");
    command
        .add("--region", options.region,
             "With --start: LEFT,TOP,RIGHT,BOTTOM in canvas heights; instances whose centre lies outside stay as they are")
        .delimiter(',')
        .expected(4)
        .needs(start);
    command
        .add("--surface", options.surface,
             "The pattern is to read as the drawing on what this output's light falls on, as 'calibrate SITE --write' saw it; "
             "refined method only")
        .typeName("SITE:OUTPUT");
    command.add("--image", options.image, "Also write the pattern, white on black and in the guide's size, as PNG");
    command.addFlag("--shadows", options.shadows,
                    "The shapes are dark and cover what is dark in the drawing, like leaves in a show's foliage");
    command.addFlag("--invert", options.invert, "The drawing is dark ink on white paper: what is dark becomes light");
    command.add("--seed", options.seed, "Random seed: the same seed gives the same pattern")
        .range(std::uint64_t{0}, std::uint64_t{std::numeric_limits<std::int64_t>::max()})
        .showDefault();
    command.add("--threads", options.threads, "Number of threads; does not change the pattern").range(1, 256);
    command.add("--report", options.report, "Also write figures, as JSON");
    command.addFlag("--watch", options.watch, "Show the search in a window");
    command.footer(
        "During the search, the space bar pauses and resumes; Escape, q and Ctrl-C end it with the best pattern so far.");
}

// What shapes that are dark have to cover, so that the light between them reads as the drawing: its
// negative in the compared space, in stored values.
GreyImage shadeOf(GreyImage drawing, pattern::GuideTransfer transfer, pattern::CompareSpace space) {
    drawing = inverted(comparedGuide(std::move(drawing), transfer, space));
    if (space == pattern::CompareSpace::Light && transfer == pattern::GuideTransfer::Srgb)
        for (float& value : drawing.pixels()) value = srgbFromLinear(value);
    return drawing;
}

// The shapes to use, each with its own settings.
Result<std::vector<pattern::ShapeSettings>> chosenShapes(const Options& options, const pattern::PatternSettings& settings,
                                                         const std::optional<ShapePattern>& start) {
    if (start) {
        std::vector<pattern::ShapeSettings> chosen;
        for (const pattern::ElementalShape& shape : start->shapes) chosen.push_back({shape, settings.ownOf(shape)});
        return chosen;
    }
    if (options.shapes.empty() && !settings.shapes.empty()) return settings.shapes;
    std::vector<pattern::ShapeSettings> chosen;
    for (const std::string& name : options.shapes.empty() ? std::vector<std::string>{"triangle"} : options.shapes) {
        pattern::ElementalShape shape = TRY(pattern::loadShape(name));
        pattern::PatternSearch::Options::Shape own = settings.ownOf(shape);
        chosen.push_back({std::move(shape), std::move(own)});
    }
    return chosen;
}

// Whether a .gltf refers to further files. One with embedded buffers can be copied alone.
bool hasOtherFiles(const fs::path& file) {
    const auto text = readFile(file);
    const Report gltf = parseJson(text ? *text : "");
    const auto buffers = gltf.find("buffers");
    return buffers != gltf.end() && std::any_of(buffers->begin(), buffers->end(), [](const Report& buffer) {
               const auto uri = buffer.find("uri");
               return uri == buffer.end() || !uri->is_string() || !uri->get<std::string>().starts_with("data:");
           });
}

// Names each shape from a file by its place beside the pattern, and adds the files to put there to
// `files`.
Result<void> placeShapes(const fs::path& output, std::vector<pattern::ShapeSettings>& chosen, std::vector<Material>& files) {
    std::set<std::string> names;
    for (auto& [shape, own] : chosen) {
        const std::string given = shape.file.empty() ? shape.name : shape.file.string();
        if (!shape.file.empty()) {
            const fs::path file = shape.file;
            files.push_back(materialFor(output, file, file.filename().string()));
            if (files.back().copied && endingOf(file) == ".gltf" && hasOtherFiles(file))
                return Error(fmt::format(
                    "{}: keeps its vertices in a second file, so it cannot be copied beside the pattern; export it as .glb",
                    given));
            shape.name = files.back().name;
            shape.file = fs::absolute(output).parent_path() / shape.name;
        }
        if (!names.insert(shape.name).second)
            return Error(fmt::format("the shape {}, or another one of that name, is given twice", given));
    }
    return {};
}

// `quality`, `loop`: in the space that was compared; `light`: in light.
Report reportOf(PatternSearch::Method method, const PatternSearch::Found& found, const pattern::PatternQuality& quality,
                const pattern::PatternQuality& light, const pattern::LoopQuality& loop, Time took) {
    Report report;
    report["method"] = name(method);
    report["compare"] = name(found.pattern.compare);
    report["z"] = quality.z;
    report["z_bound"] = quality.zBound;
    report["tone"] = quality.tone;
    report["z_light"] = light.z;
    report["tone_light"] = light.tone;
    report["overlap"] = quality.overlap;
    report["loop_z"] = loop.z;
    report["loop_tone"] = loop.tone;
    report["local_displacement"] = loop.localDisplacement;
    report["instances"] = found.pattern.instances.size();
    report["triangles"] = found.pattern.triangleCount();
    report["iterations"] = found.summary.iterations;
    report["evaluations"] = found.summary.evaluations;
    report["seconds"] = seconds(took);
    report["stop_reason"] = name(found.summary.reason);
    report["seed"] = found.pattern.seed;
    report["guide_transfer"] = name(found.pattern.guideTransfer);
    Report& history = report["history"] = {{"z_min", Report::array()}, {"z_max", Report::array()}, {"accepted", Report::array()}};
    for (const PatternSearch::Iteration& iteration : found.summary.history) {
        history["z_min"].push_back(iteration.zMin);
        history["z_max"].push_back(iteration.zMax);
        history["accepted"].push_back(iteration.accepted);
    }
    return report;
}

// The pattern of --start. Error: as readPattern(), or the other options do not fit it.
Result<ShapePattern> startingPattern(const Options& options, const GreyImage& guide) {
    const std::string file = options.start->string();
    if (options.method != PatternSearch::Method::Refined)
        return Error("--start: the paper's method always starts from a random pattern; leave --method out");
    if (!options.shapes.empty()) return Error(fmt::format("--start: {} brings its own shapes; leave --shapes out", file));
    ShapePattern pattern = TRY(pattern::readPattern(*options.start));
    const double aspect = double(guide.width()) / guide.height();
    // The pattern's aspect is that of its size in whole pixels.
    if (std::abs(aspect - pattern.aspect()) * pattern.height > 1)
        return Error(fmt::format("{}: its canvas has an aspect of {:.4f}, and {} one of {:.4f}; they cannot be compared", file,
                                 pattern.aspect(), options.guide.string(), aspect));
    if (pattern.instances.empty()) return Error(fmt::format("{}: has no instances to start from; leave --start out", file));
    return pattern;
}

// How often the window is updated, and its size.
constexpr Time kShowEvery = std::chrono::milliseconds(50);
constexpr glm::ivec2 kWindow{960, 540};

// Searches until the settings, the clock or a person stops it. `limit`: seconds. `window`: shows
// the search; may be null.
PatternSearch::Found search(const GreyImage& guide, ShapePattern pattern, const PatternSearch::Options& options,
                            std::optional<double> limit, int threads, Clock& clock, drivers::PictureWindow* window) {
    Attendance attendance(clock, [&] { return window != nullptr ? window->pollKey() : std::nullopt; });
    Progress progress("pattern", clock, std::cerr, standardErrorIsTerminal());
    const auto worked = [&] { return clock.now() - attendance.paused(); };
    const Time start = worked();
    std::optional<int> planned;
    if (options.iterations < std::numeric_limits<int>::max()) planned = options.iterations;
    // The refined method stops by its plan and not by the clock, so that the search can be
    // repeated.
    const bool planning = options.method == PatternSearch::Method::Refined;
    std::optional<Time> shown;
    const auto askStop = [&](const PatternSearch::Progress& now) -> std::optional<PatternSearch::StopReason> {
        if (window != nullptr && (!shown || clock.now() - *shown >= kShowEvery)) {
            window->show(now.picture());
            shown = clock.now();
        }
        const auto tell = [&](const char* how) {
            const double elapsed = seconds(worked() - start);
            const double byTime = limit && elapsed < *limit ? elapsed / *limit : limit ? 1 : 0;
            const double byCount = planned ? double(now.iterations) / *planned : 0;
            progress.update(planning && planned ? byCount : std::max(byTime, byCount),
                            fmt::format("z {:.4f}  {} instances{}", now.z, now.instances, how));
        };
        tell("");
        if (!attendance.goesOn([&] { tell("  paused, space resumes"); })) return PatternSearch::StopReason::Interrupted;
        if (limit && seconds(worked() - start) >= *limit && !(planning && planned)) return PatternSearch::StopReason::Time;
        return std::nullopt;
    };
    // Plans by the speed of the first tenth, measured from the first iteration on.
    std::optional<Time> running;
    const auto plan = [&](const PatternSearch::Progress& now) -> std::optional<int> {
        if (!running) running = worked();
        const double elapsed = seconds(worked() - *running), left = limit ? *limit - seconds(*running - start) : 0;
        if (limit) planned = PatternSearch::iterationsWithin(left, now.iterations, elapsed);
        return planned;
    };
    return PatternSearch::run(guide, std::move(pattern), options, threads, askStop, plan);
}

// What the search needs, read and checked before it begins.
struct Task {
    GreyImage guide;     // stored values
    GreyImage compared;  // the guide in the space that the pattern is compared in
    pattern::PatternSettings settings;
    std::optional<double> limit;  // seconds
    ShapePattern pattern;         // with the shapes; with instances if it is the one to start from
    Material guideFile;
    std::vector<Material> shapeFiles;
};

Result<GreyImage> readGuide(const Options& options) {
    GreyImage guide = TRY(readGrey(options.guide));
    TRY(checkDrawn(guide, options.guide));
    if (isInkOnPaper(guide) && !options.invert)
        log::warning("pattern",
                     fmt::format("{}: looks like dark ink on white paper, but white becomes light; use --invert to light the ink",
                                 options.guide.string()));
    return options.invert ? inverted(std::move(guide)) : guide;
}

// The settings file with the command line's options in place of its own.
Result<pattern::PatternSettings> readSettings(const Options& options) {
    pattern::PatternSettings settings;
    if (options.settings) settings = TRY(pattern::readPatternSettings(*options.settings));
    settings.search.method = options.method;
    if (options.instances) settings.search.instances = *options.instances;
    if (options.targetZ) settings.search.targetZ = *options.targetZ;
    if (options.iterations || options.seconds)
        settings.search.iterations = options.iterations.value_or(std::numeric_limits<int>::max());
    if (!options.region.empty())
        settings.search.region = {{options.region[0], options.region[1]}, {options.region[2], options.region[3]}};
    return settings;
}

std::optional<double> timeLimit(const Options& options, const pattern::PatternSettings& settings) {
    if (options.seconds || options.iterations) return options.seconds;
    const bool limited = settings.seconds || settings.search.iterations < std::numeric_limits<int>::max();
    return limited ? settings.seconds : kDefaultSeconds;
}

// The name tells `check` what the shapes are for: shapes made as light cannot serve as leaves.
Material guideFileOf(const Options& options) {
    const std::string stem = options.output.stem().stem().string();
    if (options.shadows) return {{}, stem + ".shadows.png", false};
    if (options.invert) return {{}, stem + ".inverted.png", false};
    return materialFor(options.output, options.guide, "guide" + options.guide.extension().string());
}

Result<Task> prepare(const Options& options) {
    TRY(checkWritable(options.output));
    for (const auto& file : {options.image, options.report})
        if (file) TRY(checkWritable(*file));
    Task task;
    task.guide = TRY(readGuide(options));
    task.settings = TRY(readSettings(options));
    std::optional<ShapePattern> start;
    if (options.start) start = TRY(startingPattern(options, task.guide));
    if (options.surface && options.method == PatternSearch::Method::Paper)
        return Error("--surface: only the refined method heeds a surface; leave --method out");
    if (options.surface && options.shadows)
        return Error("--surface: shapes that are dark give no light; leave --shadows or --surface out");
    TRY(task.settings.search.check());
    task.limit = timeLimit(options, task.settings);
    std::vector<pattern::ShapeSettings> shapes = TRY(chosenShapes(options, task.settings, start));
    TRY(placeShapes(options.output, shapes, task.shapeFiles));
    task.guideFile = guideFileOf(options);
    if (start) {
        if (task.settings.compare) start->compare = *task.settings.compare;
        task.pattern = std::move(*start);
        task.pattern.shapes.clear();  // chosenShapes() has them, by the names that they get beside the new file
        task.settings.fitMotion = false;
    } else {
        const bool isPaper = options.method == PatternSearch::Method::Paper;
        task.pattern.compare =
            task.settings.compare.value_or(isPaper ? pattern::CompareSpace::Stored : pattern::CompareSpace::Light);
        task.pattern.guideTransfer = task.settings.guideTransfer;
        task.pattern.seed = options.seed;
        task.pattern.motion = task.settings.motion;
    }
    for (auto& [shape, own] : shapes) {
        task.pattern.shapes.push_back(std::move(shape));
        task.settings.search.shapes.push_back(std::move(own));
    }
    const auto& [transfer, space] = std::pair(task.pattern.guideTransfer, task.pattern.compare);
    if (options.shadows) task.guide = shadeOf(std::move(task.guide), transfer, space);
    if (options.shadows || options.invert)  // as in the file that it is written to
        for (float& value : task.guide.pixels()) value = std::round(value * 255) / 255;
    task.compared = comparedGuide(task.guide, transfer, space);
    if (options.surface) {
        if (space != pattern::CompareSpace::Light)
            return Error("--surface: only light can be compared on a surface; write 'compare: light' in the settings");
        task.settings.search.surface = TRY(readPatternSurface(*options.surface, task.compared));
    }
    return task;
}

// Writes the files that the pattern names, then the pattern, so that it never names a file that is
// not there.
Result<void> writeFound(const Options& options, const Task& task, ShapePattern& found) {
    const fs::path folder = fs::absolute(options.output).parent_path();
    if (options.shadows || options.invert) TRY(writePng(folder / task.guideFile.name, task.guide));
    TRY(copyTo(folder, task.guideFile));
    for (const Material& file : task.shapeFiles) TRY(copyTo(folder, file));
    found.guide = folder / task.guideFile.name;
    TRY(writePattern(options.output, found));
    if (options.image) TRY(writePng(*options.image, drawWhiteOnBlack(found, task.guide.width(), task.guide.height())));
    return {};
}

Result<void> run(const Options& options) {
    Task task = TRY(prepare(options));
    std::unique_ptr<drivers::PictureWindow> window;
    if (options.watch) window = TRY(drivers::PictureWindow::open(options.output.filename().string(), kWindow));
    SteadyClock clock;
    PatternSearch::Found found =
        search(task.compared, std::move(task.pattern), task.settings.search, task.limit, options.threads, clock, window.get());
    const Time took = clock.now();
    if (task.settings.fitMotion)
        found.pattern.motion = fittedMotion(found.pattern, task.compared, options.threads, task.settings.search.surface.get());
    TRY(writeFound(options, task, found.pattern));

    const pattern::PatternQuality quality = measure(found.pattern, task.compared);
    const pattern::PatternQuality light =
        measure(found.pattern, comparedGuide(task.guide, found.pattern.guideTransfer, pattern::CompareSpace::Light));
    const pattern::LoopQuality loop = pattern::LoopMeasure(found.pattern, task.compared, options.threads).in({}, kLoopMoments);
    Report report = reportOf(options.method, found, quality, light, loop, took);
    std::string onSurface;
    if (const GreyImage* surface = task.settings.search.surface.get()) {
        const pattern::PatternQuality seen = measure(found.pattern, task.compared, surface);
        const double moving =
            pattern::LoopMeasure(found.pattern, task.compared, options.threads, surface).in({}, kLoopMoments).tone;
        report.update({{"z_surface", seen.z}, {"tone_surface", seen.tone}, {"loop_tone_surface", moving}});
        onSurface = fmt::format("; on the surface z {:.4f}, tone {:.4f}, moving tone {:.4f}", seen.z, seen.tone, moving);
    }
    if (options.report) TRY(writeReport(*options.report, report));
    fmt::print("{}: {}, {} instances, tone {:.4f}, moving tone {:.4f}{}\n", options.output.string(), found.summary.brief(),
               found.pattern.instances.size(), quality.tone, loop.tone, onSurface);
    return {};
}

}  // namespace

void addPatternCommand(Program& program) {
    addCommand<Options>(program, "pattern", "Find a light pattern that reads as a guide drawing", declare, run);
}

}  // namespace fantascope::app
