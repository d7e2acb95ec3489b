#include "app/base/interrupt.h"
#include "app/base/output.h"
#include "app/base/progress.h"
#include "app/base/report.h"
#include "app/command/commands.h"
#include "app/export/cast_scene.h"

#include "theatre/print/fabrication.h"

#include "core/clock.h"
#include "plot/fabrication_figures.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

namespace fantascope::app {
namespace {

namespace fs = std::filesystem;
using theatre::Fabrication;

constexpr double kLeastIou = 0.99;  // of the print's shadow and the poses': below it is said
constexpr glm::ivec2 kView{1200, 900};

struct Options {
    fs::path cast, output;
    std::optional<std::size_t> frame;
    Fabrication::Options print;
    std::optional<fs::path> sheet, view, report;
};

void declare(Command& command, Options& options) {
    const Fabrication::Options& print = options.print;
    command.add("CAST", options.cast, "The poses, *.cast.yaml, as 'fantascope pose' or 'fantascope adapt' left them").required();
    addOutOption(command, options.output, "The solid to write, binary STL: millimetres, z up")
        .required()
        .check(onlyEnding(".stl", "STL"));
    command.add("--frame", options.frame, "of a cast that moves, from 0 (default: the frame of the principal poses)");
    command.add("--height", options.print.height, "Of the print from the plate's upper side to its highest point, mm")
        .showDefault();
    command
        .add("--plate", options.print.plate,
             "Thickness of the base plate, mm (default: 3, and of a high print 4 % of its height)")
        .defaultText("");
    command.add("--margin", options.print.margin, "Of the base plate around what stands on it, mm").showDefault();
    command
        .add("--wall", options.print.wall, "The thinnest wall that the printer makes well, mm; what is thinner becomes as thick")
        .showDefault();
    command
        .add("--detail", options.print.cell,
             fmt::format("How fine the surface is made, mm (default: {:.2f} for {:g} mm of height)",
                         Fabrication::cellFor(print.height, print.wall), print.height))
        .defaultText("");
    command.add("--sheet", options.sheet, "Also draw where lamp and screen stand, with all distances: PDF or SVG, on A4")
        .check({[](const std::string& file) {
                    const std::string ending = fs::path(file).extension().string();
                    return ending == ".pdf" || ending == ".svg" ? "" : fmt::format("'{}' does not end in .pdf or .svg", file);
                },
                "PDF|SVG"});
    command.add("--view", options.view, "Also draw the print").check(onlyEnding(".png", "PNG"));
    command.add("--report", options.report, "Also write figures, as JSON");
    command.footer("docs/fabricating.md tells how to print it and where the lamp goes.");
}

Report reportOf(const Options& options, const CastScene& scene, const Fabrication& made, double seconds) {
    Report report, contacts = Report::array(), thin = Report::array(), rods = Report::array();
    for (const auto& contact : made.contacts)
        contacts.push_back({{"who", contact.who},
                            {"at", {contact.place.x, contact.place.y}},
                            {"area_mm2", contact.area},
                            {"gap_mm", contact.gap},
                            {"reinforced_by_mm", contact.reinforcedBy}});
    for (const auto& part : made.thin)
        thin.push_back({{"who", part.who}, {"thickness_mm", part.thickness}, {"thick_enough_at_height_mm", part.height}});
    for (const auto& rod : made.rods) rods.push_back({{"who", rod.who}, {"length_mm", rod.length}});
    report["frame"] = scene.frame;
    report["height_mm"] = options.print.height;
    report["scale"] = made.scale / 1000;
    report["shadow_iou"] = made.shadowIou;
    report["target_iou"] = made.targetIou;
    report["poses_iou"] = made.posesIou;
    report["volume_cm3"] = made.check.volume / 1000;
    report["triangles"] = made.mesh.triangles.size();
    report["pieces"] = made.check.pieces;
    report["closed"] = made.check.isClosed;
    report["manifold"] = made.check.isManifold;
    report["self_intersections"] = made.check.crossings.size();
    report["detail_mm"] = made.cell;
    report["wall_mm"] = options.print.wall;
    report["least_wall_mm"] = made.thinnestWall;
    report["least_wall_at"] = made.thinnestWallAt;
    report["share_below_wall"] = made.shareBelowWall;
    report["thickened"] = std::move(thin);
    report["contacts"] = std::move(contacts);
    report["rods"] = std::move(rods);
    report["lamp_mm"] = {made.light.x, made.light.y, made.light.z};
    report["screen_mm"] = made.screen;
    report["warnings"] = made.warnings;
    report["seconds"] = seconds;
    return report;
}

Result<Fabrication> fabricate(const Options& options, const CastScene& scene, const Clock& clock) {
    const Interrupt interrupt;
    Progress progress("fabricate", clock, std::cerr, standardErrorIsTerminal());
    return theatre::fabricate(scene.problem, scene.dofs, options.print,
                              {.tell = [&](double share, const char* what) { progress.update(share, what); },
                               .askStop = [&] { return interrupt.requested(); }});
}

Result<void> run(const Options& options) {
    const SteadyClock clock;
    const Time start = clock.now();
    std::vector<fs::path> outputs{options.output};
    for (const auto& file : {options.sheet, options.view, options.report})
        if (file) outputs.push_back(*file);
    for (const fs::path& file : outputs) TRY(checkWritable(file));
    TRY(options.print.check());
    const CastScene scene = TRY(readCastScene(options.cast, options.frame));
    const Fabrication made = TRY(fabricate(options, scene, clock));
    TRY(writeStl(options.output, made.mesh));
    if (options.sheet) TRY(plot::fabricationSheet(made, scene.problem.targets[0]).writeAsPaper(*options.sheet));
    if (options.view) TRY(writePng(*options.view, plot::fabricationView(made, kView.x, kView.y)));
    if (options.report) TRY(writeReport(*options.report, reportOf(options, scene, made, seconds(clock.now() - start))));
    for (const std::string& warning : made.warnings) fmt::print(stderr, "fantascope: {}\n", warning);
    if (made.shadowIou < kLeastIou)
        fmt::print(stderr,
                   "fantascope: its shadow and the poses' agree to {:.3f} only; print it higher, or with a thinner --wall, and "
                   "let nothing hang in the air\n",
                   made.shadowIou);
    fmt::print(
        "{}: {:.0f} mm high at 1:{:.1f}, {:.1f} cm3, {} triangles, one closed piece; its shadow agrees with the poses' to {:.4f} "
        "and with the target to {:.3f} (theirs: {:.3f})\n",
        options.output.string(), options.print.height, 1000 / made.scale, made.check.volume / 1000, made.mesh.triangles.size(),
        made.shadowIou, made.targetIou, made.posesIou);
    for (const auto& contact : made.contacts)
        if (contact.reinforcedBy > 0)
            fmt::print("{} stands on {:.1f} mm2: reinforced by {:.1f} mm around\n", contact.who, contact.area,
                       contact.reinforcedBy);
    for (const auto& part : made.thin)
        fmt::print("{} is {:.2f} mm thick: made {:g} mm; thick enough by itself at --height {:.0f}\n", part.who, part.thickness,
                   options.print.wall, std::ceil(part.height));
    if (!made.thinnestWallAt.empty()) fmt::print("thinnest now: {:.2f} mm, {}\n", made.thinnestWall, made.thinnestWallAt);
    fmt::print("lamp: {:.1f} mm in front of the screen, {:.1f} mm above the plate's upper side\n", made.screen - made.light.y,
               made.light.z);
    return {};
}

}  // namespace

void addFabricateCommand(Program& program) {
    addCommand<Options>(program, "fabricate", "Make a cast's poses a solid for a 3D printer", declare, run);
}

}  // namespace fantascope::app
