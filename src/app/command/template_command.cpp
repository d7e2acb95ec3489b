#include "app/base/data_folder.h"
#include "app/base/geometry_options.h"
#include "app/command/commands.h"
#include "app/export/guide_template.h"
#include "app/site/site_file.h"
#include "app/site/site_models.h"
#include "drivers/site/simulation.h"

#include "core/parallel.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fantascope::app {
namespace {

namespace fs = std::filesystem;

constexpr int kRows = 1080;  // without --size

struct Options {
    fs::path site, file;
    std::string output;
    std::optional<glm::ivec2> size;
    std::optional<double> grid;
    int threads = hardwareThreads();
};

void declare(Command& command, Options& options) {
    command.add("SITE", options.site, "A site's folder, or a site.yaml").required();
    addProjectorOption(command, options.output, "The projector whose canvas to draw").required();
    addOutOption(command, options.file, "The picture to write, PNG").required();
    addSizeOption(
        command, "--size", options.size,
        fmt::format("Size of the picture, and so of the guide (default: {} rows, in the canvas's aspect on its surface)", kRows));
    command.add("--grid", options.grid, "Metres between grid lines (default: some ten lines on the canvas)").range(0.001, 1000.0);
    command.add("--threads", options.threads, "Number of threads; does not change the picture").range(1, 256);
}

// 1, 2 or 5 times a power of ten that divides a length into about `parts` parts.
double handyStep(double length, double parts) {
    const double rough = length / parts, power = std::pow(10, std::floor(std::log10(rough)));
    for (const double factor : {1.0, 2.0, 5.0})
        if (factor * power >= 0.75 * rough) return factor * power;
    return 10 * power;
}

Result<void> run(const Options& options) {
    const show::Site site = TRY(readSite(options.site));
    const std::size_t index = TRY(outputNamed(site, options.output));
    if (!site.simulation)
        return Error(fmt::format(
            "{}: has no 'simulation' section, so it is not known what stands there: list ground, wall and objects under "
            "simulation: objects (drivers/site/README.md), or draw over a photograph taken from the projector's lens "
            "while it shows a white canvas, cropped to that canvas",
            site.file.string()));
    const site::NominalSite nominal = TRY(simulationOf(site));
    const site::Simulation simulation = TRY(site::readSimulation(*site.simulation, nominal));
    const show::Output& output = site.outputs[index];
    std::optional<vision::Plane> surface;
    if (output.surface) surface = vision::Plane{output.surface->point, output.surface->normal};
    const CanvasView view{output.name, nominal.outputs[index].projector, surface, output.projection.warp, simulation.objects};

    const auto metres = view.sizeOnSurface();
    const glm::dvec2 proportions = metres.value_or(glm::dvec2(output.size()));
    const glm::ivec2 size =
        options.size.value_or(glm::ivec2(2 * std::max(1L, std::lround(kRows * proportions.x / proportions.y / 2)), kRows));
    const double grid = options.grid.value_or(handyStep(metres ? metres->y : 5, 8));
    const GuideTemplate drawn = drawGuideTemplate(view, size, grid, options.threads);
    TRY(writePng(options.file, drawn.picture));

    const auto share = [&](auto wanted) {
        const auto count = std::ranges::count_if(drawn.meets.pixels(), wanted);
        return 100 * static_cast<double>(count) / static_cast<double>(drawn.meets.pixels().size());
    };
    fmt::print(
        "{}: {} x {}, the canvas of '{}'{}; {:.1f} % of it falls on other objects, {:.1f} % on nothing, {:.1f} % gets no light\n",
        options.file.string(), size.x, size.y, output.name,
        metres ? fmt::format(", {:.2f} x {:.2f} m", metres->x, metres->y) : "",
        share([](Meets meets) { return meets == Meets::Object; }), share([](Meets meets) { return meets == Meets::Nothing; }),
        share([](Meets meets) { return meets == Meets::NoLight; }));
    return {};
}

}  // namespace

void addTemplateCommand(Program& program) {
    addCommand<Options>(program, "template", "Draw the site from a projector's point of view, as a picture to draw a guide over",
                        declare, run);
}

}  // namespace fantascope::app
