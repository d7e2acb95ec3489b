#include "app/base/report.h"
#include "app/command/commands.h"
#include "app/command/night_report.h"
#include "app/command/wall_sight.h"
#include "app/export/cast_scene.h"

#include "pattern/shape/shape_pattern.h"

#include "core/config/naming.h"
#include "core/file.h"
#include "plot/cast_figures.h"
#include "plot/cast_picture.h"
#include "plot/figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <optional>
#include <string_view>
#include <vector>

namespace fantascope::app {
namespace {

namespace fs = std::filesystem;

enum class Subject { Pattern, Search, Night, Sight, Cast };
enum class Figure { Difference, Trajectories, Spectrum, Search, Night, Wall, Cast, Stage, Side, Shadow, Actors };

struct Entry {
    std::string_view name;
    Figure figure;
    Subject of;
};
// The first entry of a subject is the default.
constexpr Entry kFigures[] = {{"difference", Figure::Difference, Subject::Pattern},
                              {"trajectories", Figure::Trajectories, Subject::Pattern},
                              {"spectrum", Figure::Spectrum, Subject::Pattern},
                              {"search", Figure::Search, Subject::Search},
                              {"night", Figure::Night, Subject::Night},
                              {"wall", Figure::Wall, Subject::Sight},
                              {"cast", Figure::Cast, Subject::Cast},
                              {"stage", Figure::Stage, Subject::Cast},
                              {"side", Figure::Side, Subject::Cast},
                              {"shadow", Figure::Shadow, Subject::Cast},
                              {"actors", Figure::Actors, Subject::Cast}};

// What it is, and which command makes it.
struct SubjectName {
    std::string_view what, made;
};
SubjectName nameOf(Subject subject) {
    switch (subject) {
        case Subject::Search:
            return {"the report of a search", "'fantascope pattern' with --report FILE.json"};
        case Subject::Night:
            return {"the report of a run", "'fantascope run' or 'fantascope rehearse' with --report FILE.json"};
        case Subject::Sight:
            return {"a picture of the site's camera, *.png or *.jpg",
                    "'fantascope run' or 'fantascope rehearse' with --record FOLDER"};
        case Subject::Cast:
            return {"a cast, *.cast.yaml", "'fantascope pose'"};
        default:
            return {"a pattern, *.pattern.yaml", "'fantascope pattern'"};
    }
}

std::string figuresOf(Subject subject) {
    std::string names;
    for (const Entry& entry : kFigures)
        if (entry.of == subject) names += fmt::format("{}{}", names.empty() ? "" : ", ", entry.name);
    return names;
}

// A file to draw. `report`: what a *.json holds.
struct Input {
    fs::path file;
    Subject subject;
    Report report;
};

Result<Input> readInput(const fs::path& file) {
    if (file.filename().string().ends_with(".cast.yaml")) return Input{file, Subject::Cast, {}};
    for (const char* picture : {".png", ".jpg", ".jpeg"})
        if (file.extension() == picture) return Input{file, Subject::Sight, {}};
    if (file.extension() != ".json") return Input{file, Subject::Pattern, {}};
    Report report = parseJson(TRY(readFile(file)));
    const bool isSearch = report.is_object() && report.contains("history");
    if (!isSearch && !isNight(report))
        return Error(fmt::format("{}: plot draws reports of searches ({}) and of runs ({}), and this is neither", file.string(),
                                 nameOf(Subject::Search).made, nameOf(Subject::Night).made));
    return Input{file, isSearch ? Subject::Search : Subject::Night, std::move(report)};
}

struct Options {
    fs::path input, output;
    std::optional<Figure> figure;
    std::size_t frame = 0;
    WallRequest wall;
};

std::string onlyPlot(const std::string& file) {
    return plot::Page::knows(file) ? "" : fmt::format("'{}' cannot be written: a picture's name must end in .png or .svg", file);
}

void declare(Command& command, Options& options) {
    command
        .add("INPUT", options.input,
             "A pattern, *.pattern.yaml; the report of its search or of a run, *.json; a camera's picture of the site, *.png; or "
             "a cast, *.cast.yaml")
        .required();
    addProjectorOption(command, options.wall.output, "For a camera's picture: the output to compare");
    addOutOption(command, options.output, "The picture to write, PNG or SVG").required().check({onlyPlot, "PNG|SVG"});
    std::vector<std::pair<std::string, Figure>> figures;
    for (const Entry& entry : kFigures) figures.emplace_back(entry.name, entry.figure);
    command.addChoice<Figure>(
        "--figure", options.figure, figures,
        "For a pattern: difference (from its guide, the default), trajectories or spectrum (of its movement). For the report of "
        "a search: search (z over the iterations). For the report of a run: night (the camera's scores over the time, and what "
        "went wrong). For a camera's picture: wall (what is wanted on the wall, what is seen, and the difference). For a cast: "
        "cast (stage, shadow and actors, the default), stage (from behind the "
        "lamp), side (from the side), shadow (by actor) or actors (each actor's shadow)");
    command.add("--frame", options.frame, "For a cast that moves: the frame, counted from 0").showDefault();
    command.add("--site", options.wall.site, "For a camera's picture: the site on which it was taken");
    command.add("--guide", options.wall.guide,
                "For a camera's picture: what the output was showing, a *.pattern.yaml or a drawing");
    command.add("--before", options.wall.before, "For a camera's picture: another one of the same site, drawn above it");
}

Error damaged(const Input& input) {
    const auto [what, made] = nameOf(input.subject);
    return Error(fmt::format("{}: is damaged, or is not {}; make one by {}", input.file.string(), what, made));
}

Result<plot::SearchHistory> historyOf(const Input& input) {
    try {
        const auto& history = input.report.at("history");
        const plot::SearchHistory read{.method = input.report.at("method"),
                                       .zMin = history.at("z_min"),
                                       .zMax = history.at("z_max"),
                                       .accepted = history.at("accepted"),
                                       .zBound = input.report.at("z_bound")};
        if (read.zMin.size() == read.zMax.size() && read.zMin.size() == read.accepted.size()) return read;
    } catch (const nlohmann::json::exception&) {  // a key is missing or has another type
    }
    return damaged(input);
}

Result<plot::Page> drawNight(const Input& input) {
    const auto night = nightOf(input.report);
    if (!night) return damaged(input);
    return plot::nightFigure(*night);
}

Result<plot::Page> drawPattern(const fs::path& file, Figure figure) {
    const pattern::ShapePattern pattern = TRY(pattern::readPattern(file));
    if (figure == Figure::Difference) {
        const auto guide = readGrey(pattern.guide);
        if (!guide) return namedIn(file, pattern.guide, guide.error());
        return plot::differenceFigure(pattern, comparedGuide(*guide, pattern.guideTransfer, pattern.compare));
    }
    return figure == Figure::Trajectories ? plot::trajectoriesFigure(pattern) : plot::spectrumFigure(pattern);
}

Result<plot::Page> drawCast(const fs::path& file, std::size_t frame, Figure figure) {
    const CastScene scene = TRY(readCastScene(file, frame));
    const plot::CastPicture cast = plot::castPicture(scene.problem, scene.dofs);
    std::vector<plot::Page> pages;
    const auto has = [&](Figure part) { return figure == part || figure == Figure::Cast; };
    if (has(Figure::Stage)) pages.push_back(plot::stageFigure(cast.view, cast.view.overview(plot::kStageAspect)));
    if (figure == Figure::Side) pages.push_back(plot::stageFigure(cast.view, cast.view.fromTheSide(plot::kStageAspect)));
    if (has(Figure::Shadow)) pages.push_back(cast.shadows());
    if (has(Figure::Actors)) pages.push_back(cast.each());
    return plot::stacked(pages);
}

Result<plot::Page> draw(const Options& options) {
    const Input input = TRY(readInput(options.input));
    const auto ofSubject = [&](const Entry& entry) { return entry.of == input.subject; };
    const Figure figure = options.figure.value_or(std::find_if(std::begin(kFigures), std::end(kFigures), ofSubject)->figure);
    const Entry& entry =
        *std::find_if(std::begin(kFigures), std::end(kFigures), [&](const Entry& e) { return e.figure == figure; });
    if (entry.of != input.subject)
        return Error(fmt::format("{}: is {}, whose figures are: {}; --figure {} needs {}, made by {}", input.file.string(),
                                 nameOf(input.subject).what, figuresOf(input.subject), entry.name, nameOf(entry.of).what,
                                 nameOf(entry.of).made));
    if (input.subject != Subject::Sight && options.wall != WallRequest())
        return Error(fmt::format("{}: is {}; --site, --output, --guide and --before are for {}", input.file.string(),
                                 nameOf(input.subject).what, nameOf(Subject::Sight).what));
    if (input.subject == Subject::Search) return plot::searchFigure(TRY(historyOf(input)));
    if (input.subject == Subject::Night) return drawNight(input);
    if (input.subject == Subject::Sight) return drawWall(input.file, options.wall);
    if (input.subject == Subject::Cast) return drawCast(input.file, options.frame, figure);
    return drawPattern(input.file, figure);
}

Result<void> run(const Options& options) {
    const plot::Page page = TRY(draw(options));
    return page.write(options.output);
}

}  // namespace

void addPlotCommand(Program& program) {
    addCommand<Options>(program, "plot", "Draw a pattern, its search, its movement, a run, or a cast as a figure", declare, run);
}

}  // namespace fantascope::app
