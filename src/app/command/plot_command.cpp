#include "app/base/report.h"
#include "app/command/commands.h"
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

enum class Subject { Pattern, Report, Cast };
enum class Figure { Difference, Trajectories, Spectrum, Search, Cast, Stage, Side, Shadow, Actors };

struct Entry {
    std::string_view name;
    Figure figure;
    Subject of;
};
// The first entry of a subject is the default.
constexpr Entry kFigures[] = {{"difference", Figure::Difference, Subject::Pattern},
                              {"trajectories", Figure::Trajectories, Subject::Pattern},
                              {"spectrum", Figure::Spectrum, Subject::Pattern},
                              {"search", Figure::Search, Subject::Report},
                              {"cast", Figure::Cast, Subject::Cast},
                              {"stage", Figure::Stage, Subject::Cast},
                              {"side", Figure::Side, Subject::Cast},
                              {"shadow", Figure::Shadow, Subject::Cast},
                              {"actors", Figure::Actors, Subject::Cast}};

Subject subjectOf(const fs::path& input) {
    return input.extension() == ".json"                        ? Subject::Report
           : input.filename().string().ends_with(".cast.yaml") ? Subject::Cast
                                                               : Subject::Pattern;
}

struct Options {
    fs::path input, output;
    std::optional<Figure> figure;
    std::size_t frame = 0;
};

std::string onlyPlot(const std::string& file) {
    return plot::Page::knows(file) ? "" : fmt::format("'{}' cannot be written: a picture's name must end in .png or .svg", file);
}

void declare(Command& command, Options& options) {
    command.add("INPUT", options.input, "A pattern, *.pattern.yaml, the report of its search, *.json, or a cast, *.cast.yaml")
        .required();
    addOutOption(command, options.output, "The picture to write, PNG or SVG").required().check({onlyPlot, "PNG|SVG"});
    std::vector<std::pair<std::string, Figure>> figures;
    for (const Entry& entry : kFigures) figures.emplace_back(entry.name, entry.figure);
    command.addChoice<Figure>(
        "--figure", options.figure, figures,
        "For a pattern: difference (from its guide, the default), trajectories or spectrum (of its movement). For a report: "
        "search (z over the iterations). For a cast: cast (stage, shadow and actors, the default), stage (from behind the "
        "lamp), side (from the side), shadow (by actor) or actors (each actor's shadow)");
    command.add("--frame", options.frame, "For a cast that moves: the frame, counted from 0").showDefault();
}

Result<plot::SearchHistory> readHistory(const fs::path& file) {
    const Report report = parseJson(TRY(readFile(file)));
    try {
        const auto& history = report.at("history");
        const plot::SearchHistory read{.method = report.at("method"),
                                       .zMin = history.at("z_min"),
                                       .zMax = history.at("z_max"),
                                       .accepted = history.at("accepted"),
                                       .zBound = report.at("z_bound")};
        if (read.zMin.size() == read.zMax.size() && read.zMin.size() == read.accepted.size()) return read;
    } catch (const nlohmann::json::exception&) {  // a key is missing or has another type
    }
    return Error(
        fmt::format("{}: is not a report of a search; make one with 'fantascope pattern GUIDE -o P.pattern.yaml --report {}'",
                    file.string(), file.filename().string()));
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
    const Subject subject = subjectOf(options.input);
    const auto ofSubject = [&](const Entry& entry) { return entry.of == subject; };
    const Figure figure = options.figure.value_or(std::find_if(std::begin(kFigures), std::end(kFigures), ofSubject)->figure);
    const Entry& entry =
        *std::find_if(std::begin(kFigures), std::end(kFigures), [&](const Entry& e) { return e.figure == figure; });
    if (entry.of != subject)
        return Error(fmt::format("{}: --figure {} needs {}", options.input.string(), entry.name,
                                 entry.of == Subject::Pattern  ? "a pattern, *.pattern.yaml"
                                 : entry.of == Subject::Report ? "the report of a search, *.json"
                                                               : "a cast, *.cast.yaml"));
    if (subject == Subject::Report) return plot::searchFigure(TRY(readHistory(options.input)));
    if (subject == Subject::Cast) return drawCast(options.input, options.frame, figure);
    return drawPattern(options.input, figure);
}

Result<void> run(const Options& options) {
    const plot::Page page = TRY(draw(options));
    return page.write(options.output);
}

}  // namespace

void addPlotCommand(Program& program) {
    addCommand<Options>(program, "plot", "Draw a pattern, its search, its movement, or a cast as a figure", declare, run);
}

}  // namespace fantascope::app
