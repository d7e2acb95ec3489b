#include "app/plot_command.h"

#include "app/report.h"

#include "pattern/shape_pattern.h"

#include "core/file.h"
#include "plot/figures.h"

#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <optional>

namespace fantascope::app {
namespace {

namespace fs = std::filesystem;

enum class Figure { Difference, Search, Trajectories, Spectrum };

struct Options {
    fs::path input, output;
    std::optional<Figure> figure;
};

std::string onlyPlot(const std::string& file) {
    return plot::Page::knows(file) ? ""
                                   : fmt::format("'{}' is no picture that can be written: its name ends in .png or .svg", file);
}

void declare(CLI::App& command, Options& options) {
    command.add_option("INPUT", options.input, "A pattern, *.pattern.yaml, or the report of its search, *.json")->required();
    command.add_option("-o,--output", options.output, "The picture to write, PNG or SVG")
        ->required()
        ->check(CLI::Validator(onlyPlot, "PNG|SVG"));
    command
        .add_option(
            "--figure", options.figure,
            "of a pattern: difference (from its guide, the default), trajectories or spectrum (of its movement); of a report: "
            "search (z over the iterations)")
        ->transform(CLI::CheckedTransformer(std::map<std::string, Figure>{{"difference", Figure::Difference},
                                                                          {"search", Figure::Search},
                                                                          {"trajectories", Figure::Trajectories},
                                                                          {"spectrum", Figure::Spectrum}}));
}

Result<plot::SearchHistory> readHistory(const fs::path& file) {
    const Report report = Report::parse(TRY(readFile(file)), nullptr, false);
    try {
        const auto& history = report.at("history");
        const plot::SearchHistory read{.method = report.at("method"),
                                       .zMin = history.at("z_min"),
                                       .zMax = history.at("z_max"),
                                       .accepted = history.at("accepted"),
                                       .zBound = report.at("z_bound")};
        if (read.zMin.size() == read.zMax.size() && read.zMin.size() == read.accepted.size()) return read;
    } catch (const nlohmann::json::exception&) {  // a key that is missing, or of another type
    }
    return Error(
        fmt::format("{}: is no report of a search; make one with 'fantascope pattern GUIDE -o P.pattern.yaml --report {}'",
                    file.string(), file.filename().string()));
}

Result<plot::Page> draw(const Options& options) {
    const bool ofReport = options.input.extension() == ".json";
    const Figure figure = options.figure.value_or(ofReport ? Figure::Search : Figure::Difference);
    if (ofReport != (figure == Figure::Search))
        return Error(fmt::format("{}: --figure {}", options.input.string(),
                                 ofReport ? "needs a pattern, *.pattern.yaml; a report has the search alone"
                                          : "search needs the report of a search, *.json"));
    if (ofReport) return plot::searchFigure(TRY(readHistory(options.input)));
    const pattern::ShapePattern pattern = TRY(pattern::readPattern(options.input));
    if (figure == Figure::Difference) {
        const GreyImage guide = TRY(readGrey(pattern.guide).in(options.input.string() + ": guide"));
        return plot::differenceFigure(pattern, guide);
    }
    return figure == Figure::Trajectories ? plot::trajectoriesFigure(pattern) : plot::spectrumFigure(pattern);
}

Result<void> run(const Options& options) {
    const plot::Page page = TRY(draw(options));
    return page.write(options.output);
}

}  // namespace

void addPlotCommand(CLI::App& program, Action& action) {
    addCommand<Options>(program, action, "plot", "Draw a pattern, its search or its movement as a figure", declare, run);
}

}  // namespace fantascope::app
