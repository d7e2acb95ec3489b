#include "theatre/print/fabrication.h"

#include "theatre/body/simplify.h"
#include "theatre/energy/scene_energy.h"
#include "theatre/mask/convex_outline.h"
#include "theatre/print/print_layout.h"
#include "theatre/print/print_solid.h"
#include "theatre/stage/stage_set.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace fantascope::theatre {
namespace {

using glm::dvec2, glm::dvec3;

constexpr double kPlate = 3, kPlateShare = 0.04;  // the plate's thickness, mm
// In cells of the grid: the tolerance for simplifying the surface, and the radius around a
// self-intersection within which it is not simplified.
constexpr double kTolerance = 0.08, kKeptAround = 6;
constexpr int kTries = 5;
constexpr std::size_t kSamples = 50'000;  // triangles at which the wall behind the surface is measured
constexpr int kCellsHigh = 280, kCellsInWall = 4;

// From the solid's frame into the print's.
glm::vec3 inPrint(const dvec3& p) { return glm::vec3(p.x, -p.z, p.y); }
dvec2 inPrint(const dvec2& xz) { return {xz.x, -xz.y}; }

Fabrication::Options resolved(Fabrication::Options options) {
    if (options.plate == 0) options.plate = std::max(kPlate, kPlateShare * options.height);
    if (options.cell == 0) options.cell = Fabrication::cellFor(options.height, options.wall);
    return options;
}

struct PrintSurface {
    TriangleMesh mesh;
    SolidCheck check;
};

// The third stage: the solid's surface, in the print's frame.
Result<PrintSurface> makeSurface(VoxelSolid&& solid, double cell, const PrintStep& step) {
    TriangleMesh fine;
    {
        const VoxelSolid gone = std::move(solid);  // frees the grid's memory afterwards
        fine = gone.surface();
    }
    PrintSurface made;
    for (glm::vec3& v : fine.vertices) v = inPrint(dvec3(v));
    // The surface is simplified. Around triangles that intersect afterwards, the next attempt keeps
    // it as fine as it was.
    std::vector<glm::vec3> kept;
    const auto near = static_cast<float>(kKeptAround * cell);
    for (int attempt = 0; attempt <= kTries; ++attempt) {
        TRY(step(0.58 + 0.32 * attempt / kTries, "triangles"));
        made.mesh = attempt == kTries ? fine : simplifiedWithin(fine, kTolerance * cell, [&](const glm::vec3& place) {
            return std::none_of(kept.begin(), kept.end(), [&](const glm::vec3& k) { return glm::distance(k, place) < near; });
        });
        TRY(step(0.65 + 0.32 * attempt / kTries, "check"));
        made.check = checkSolid(made.mesh);
        if (made.check.isSound()) break;
        for (const std::uint32_t t : made.check.crossings) kept.push_back(made.mesh.vertices[made.mesh.triangles[t].x]);
    }
    if (!made.check.isSound() || made.check.pieces != 1)
        return Error("the surface did not become one closed solid; try another --detail");
    return made;
}

// Warns of further beams and curved screens: the sheet is drawn for one lamp and one flat screen.
void warnOfOtherScreens(const Stage& stage, Fabrication& made) {
    if (const Screen& screen = stage.screenOf(0); screen.isCurved())
        made.warnings.push_back(fmt::format(
            "the screen is curved: on a flat one the shadow is stretched sideways; bend it to a radius of {:.0f} mm, {}",
            made.scale * std::abs(screen.radius), screen.radius > 0 ? "hollow towards the lamp" : "bulging towards the lamp"));
    for (std::size_t beam = 1; beam < stage.beams.size(); ++beam) {
        const Screen& screen = stage.screenOf(beam);
        const dvec3 light = made.fromStage(stage.beams[beam].light), foot = made.fromStage({screen.at.x, 0, screen.at.y});
        made.warnings.push_back(fmt::format(
            "the sheet and the figures are of the first lamp; lamp {} stands {:.0f} mm to the right of the plate's middle, "
            "{:.0f} mm towards "
            "the first screen and {:.0f} mm high, and its screen goes through {:.0f} mm, {:.0f} mm, turned by {:.0f} degrees",
            beam + 1, light.x, light.y, light.z, foot.x, foot.y, screen.turn * 180 / std::numbers::pi));
    }
}

// Compares the print's shadow with the poses' and the target's.
void measureShadow(const PoseProblem& problem, const SceneEnergy& scene, const PrintFrame& print, Fabrication& made) {
    const ScreenFrame& frame = problem.targets[0].frame;
    TriangleMesh onStage = made.mesh;
    for (glm::vec3& v : onStage.vertices) v = glm::vec3(print.onStage({v.x, v.z, -v.y}));
    made.shadow = BitMask(frame.width(), frame.height());
    addShadow(frame, onStage, made.shadow);
    BitMask poses = scene.shadow(), target = problem.targets[0].mask;
    // The plate's shadow lies below the floor's line, so rows below it are cut off.
    const int floor = static_cast<int>(std::floor(frame.pixelAt(0, 0).y + 1e-6));
    for (BitMask* const mask : {&made.shadow, &poses, &target}) {
        mask->keep(0, 0, frame.width(), std::clamp(floor, 0, frame.height()));
        cutToLit(problem.stage, frame, *mask);
    }
    made.shadowIou = intersectionOverUnion(made.shadow, poses);
    made.targetIou = intersectionOverUnion(made.shadow, target);
    made.posesIou = intersectionOverUnion(poses, target);
}

// The share of a surface with another surface straight behind it at less than `wall`.
double shareBelow(const TriangleMesh& mesh, double wall) {
    const std::size_t every = mesh.triangles.size() / kSamples + 1;
    const std::vector<double> walls = thicknesses(mesh, every);
    double all = 0, below = 0;
    for (std::size_t i = 0; i < walls.size(); ++i) {
        const glm::uvec3& c = mesh.triangles[i * every];
        const dvec3 a = mesh.vertices[c.x], b = mesh.vertices[c.y], d = mesh.vertices[c.z];
        const double area = glm::length(glm::cross(b - a, d - a));
        all += area;
        if (walls[i] < wall) below += area;
    }
    return below / all;
}

// The data of the plate, its marks and the contacts, for the sheet.
void describe(const PrintLayout& layout, const PrintSolid& solid, const Fabrication::Options& options, Fabrication& made) {
    constexpr int kRound = 32;
    std::vector<dvec2> outline;
    for (const dvec2& p : layout.hull)
        for (int i = 0; i < kRound; ++i) {
            const double turn = 2 * std::numbers::pi * i / kRound;
            outline.push_back(inPrint(p) + options.margin * dvec2(std::cos(turn), std::sin(turn)));
        }
    made.plate = hullOf(outline);
    made.thickness = options.plate;
    for (const auto& line : layout.marks) {
        auto& mark = made.marks.emplace_back();
        for (const dvec2& p : line) mark.push_back(inPrint(p));
    }
    for (std::size_t i = 0; i < layout.footings.size(); ++i) {
        Fabrication::Contact& contact = made.contacts.emplace_back(layout.footings[i].contact);
        contact.reinforcedBy = solid.reinforcedBy[i];
        contact.place = inPrint(contact.place);
        for (dvec2& p : contact.outline) p = inPrint(p);
    }
}

}  // namespace

Result<void> Fabrication::Options::check() const {
    const auto within = [](const char* name, double value, double least, double most) -> Result<void> {
        if (value >= least && value <= most) return {};
        return Error(fmt::format("{} = {} must be {} .. {} mm", name, value, least, most));
    };
    TRY(within("height", height, 20, 1000));
    if (plate != 0) TRY(within("plate", plate, 1, 50));
    TRY(within("margin", margin, 4, 100));
    TRY(within("wall", wall, 0.2, 10));
    if (cell != 0) TRY(within("detail", cell, 0.05, 5));
    if (const double used = cell != 0 ? cell : cellFor(height, wall); plate != 0 && used > plate / 3)
        return Error(
            fmt::format("plate = {} mm is too thin for a detail of {:.2f} mm; three times as much, at least", plate, used));
    return {};
}

double Fabrication::cellFor(double height, double wall) {
    return std::max(height / kCellsHigh, std::min(wall / kCellsInWall, height / 100));
}

Result<Fabrication> fabricate(const PoseProblem& problem, std::span<const double> dofs, const Fabrication::Options& given,
                              const FabricationWatch& watch) {
    const Fabrication::Options options = resolved(given);
    TRY(options.check());
    const PrintStep step = [&](double share, const char* what) -> Result<void> {
        if (watch.tell) watch.tell(share, what);
        if (watch.askStop && watch.askStop()) return Error("interrupted; nothing is written");
        return {};
    };
    SceneEnergy scene(problem);
    scene.pose(dofs);
    scene.terms();
    TRY(step(0.02, "contacts"));
    const PrintLayout layout = TRY(layOut(problem, scene, options));
    PrintSolid solid = TRY(makeSolid(problem, scene, layout, options, step));
    TRY(step(0.55, "surface"));
    PrintSurface surface = TRY(makeSurface(std::move(solid.solid), options.cell, step));
    TRY(step(0.92, "shadow"));

    Fabrication made;
    made.mesh = std::move(surface.mesh);
    made.check = std::move(surface.check);
    made.scale = layout.frame.scale;
    made.stageOrigin = layout.frame.stageOrigin;
    made.cell = options.cell;
    made.thin = std::move(solid.thin);
    made.rods = std::move(solid.rods);
    made.thinnestWall = solid.thinnestWall;
    made.thinnestWallAt = std::move(solid.thinnestWallAt);
    made.warnings = layout.warnings;
    made.warnings.insert(made.warnings.end(), solid.warnings.begin(), solid.warnings.end());
    measureShadow(problem, scene, layout.frame, made);
    made.shareBelowWall = shareBelow(made.mesh, options.wall);
    made.light = made.fromStage(problem.stage.beams[0].light);
    made.screen = made.fromStage({0, 0, 0}).y;
    warnOfOtherScreens(problem.stage, made);
    describe(layout, solid, options, made);
    return made;
}

}  // namespace fantascope::theatre
