#include "theatre/print/print_layout.h"

#include "theatre/body/simplify.h"
#include "theatre/mask/convex_outline.h"

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

namespace fantascope::theatre {
namespace {

using glm::dvec2, glm::dvec3;

constexpr double kHover = 0.04;  // metres of the stage: a part no higher above the ground is meant to stand on it
constexpr double kLow = kPrintedLow, kMark = kPrintedMark;
constexpr double kLine = 30;  // least length of the line engraved along the screen, mm

// People, platforms and props in the solid's frame, with the origin at the middle of their bounding
// box.
Result<PrintLayout> placed(const PoseProblem& problem, const SceneEnergy& scene, double height) {
    PrintLayout layout;
    std::vector<PrintPiece>& pieces = layout.pieces;
    for (std::size_t i = 0; i < problem.actors.size(); ++i) {
        const auto skin = scene.skin(i);
        pieces.push_back(
            {fmt::format("actor {}", i + 1), i, false, {{skin.begin(), skin.end()}, problem.skins[i]->atRest.triangles}});
    }
    const std::vector<SceneEnergy::Thing> things = scene.things();
    for (const SceneEnergy::Thing& thing : things) {
        const auto& platforms = problem.stage.platforms;
        const bool isPlatform = std::any_of(platforms.begin(), platforms.end(),
                                            [&](const Stage::Platform& platform) { return platform.name == thing.name; });
        pieces.push_back({isPlatform ? fmt::format("platform '{}'", thing.name) : fmt::format("prop '{}'", thing.name),
                          std::nullopt, isPlatform, thing.mesh});
        if (edgesOf(thing.mesh).empty())
            layout.warnings.push_back(
                fmt::format("the mesh of prop '{}' is not closed: places behind an odd number of its faces "
                            "were taken as solid; check the print, or close its holes",
                            thing.name));
    }
    dvec3 least(std::numeric_limits<double>::infinity()), most = -least;
    for (const PrintPiece& piece : pieces)
        for (const glm::vec3& v : piece.mesh.vertices) least = glm::min(least, dvec3(v)), most = glm::max(most, dvec3(v));
    constexpr double kLeastHeight = 0.05;
    if (most.y < kLeastHeight) return Error("nothing of the cast is more than 5 cm above the floor; there is nothing to print");
    layout.frame.scale = height / most.y;
    layout.frame.stageOrigin = {0.5 * (least.x + most.x), 0, 0.5 * (least.z + most.z)};
    for (PrintPiece& piece : pieces)
        for (glm::vec3& v : piece.mesh.vertices) v = glm::vec3(layout.frame.inSolid(v));
    return layout;
}

// Groups of connected vertices of a piece that are close to the ground.
struct LowParts {
    std::vector<double> grounds;  // under each vertex, mm
    std::map<std::uint32_t, std::vector<std::uint32_t>> groups;
    double lowestGap = 0;  // of the lowest vertex, mm; no more than kHover
};

LowParts lowParts(const PrintPiece& piece, const PrintFrame& frame, const Stage& stage) {
    const double s = frame.scale;
    const auto& vertices = piece.mesh.vertices;
    LowParts low;
    std::vector<double>& grounds = low.grounds;
    grounds.resize(vertices.size());
    std::vector<std::uint32_t> group(vertices.size());
    std::iota(group.begin(), group.end(), 0u);
    const auto root = [&](std::uint32_t i) {
        while (group[i] != i) i = group[i] = group[group[i]];
        return i;
    };
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        const dvec3 place = frame.onStage(vertices[i]);
        // A part that has sunk in a little still stands there.
        grounds[i] = piece.isPlatform ? 0 : s * stage.groundUnder(place + dvec3(0, 0.5 * kHover, 0));
    }
    const auto isLow = [&](std::uint32_t i) { return vertices[i].y - grounds[i] < s * kHover; };
    for (const glm::uvec3& t : piece.mesh.triangles)
        for (int i = 0; i < 3; ++i)
            if (const std::uint32_t a = t[i], b = t[(i + 1) % 3]; isLow(a) && isLow(b)) group[root(a)] = root(b);
    for (std::uint32_t i = 0; i < vertices.size(); ++i)
        if (isLow(i)) low.groups[root(i)].push_back(i);
    low.lowestGap = s * kHover;
    for (std::uint32_t i = 0; i < vertices.size(); ++i) low.lowestGap = std::min(low.lowestGap, vertices[i].y - grounds[i]);
    return low;
}

// The footings of a piece.
std::vector<Footing> footingsOf(const PoseProblem& problem, const PrintFrame& frame, const std::vector<PrintPiece>& pieces,
                                std::size_t index) {
    const double s = frame.scale;
    const PrintPiece& piece = pieces[index];
    const auto& vertices = piece.mesh.vertices;
    const auto [grounds, groups, lowestGap] = lowParts(piece, frame, problem.stage);
    std::vector<Footing> footings;
    for (const auto& [first, members] : groups) {
        std::uint32_t lowest = members[0];
        for (const std::uint32_t i : members)
            if (vertices[i].y - grounds[i] < vertices[lowest].y - grounds[lowest]) lowest = i;
        const double gap = vertices[lowest].y - grounds[lowest];
        if (gap > std::max(0.0, lowestGap) + s * kLow) continue;  // it stands on something else
        Footing footing{index, grounds[lowest], {}, {}};
        std::vector<dvec2> plan;
        for (const std::uint32_t i : members)
            if (vertices[i].y - grounds[i] <= std::max(gap, 0.0) + s * kLow && grounds[i] == footing.ground) {
                footing.bearing.emplace_back(vertices[i]);
                plan.emplace_back(vertices[i].x, vertices[i].z);
            }
        Fabrication::Contact& contact = footing.contact;
        contact.outline = hullOf(plan);
        contact.area = areaOf(contact.outline);
        contact.gap = gap;
        contact.who = PrintLayout::partAt(problem, piece, vertices[lowest]);
        contact.place = middleOf(contact.outline);
        footings.push_back(std::move(footing));
    }
    return footings;
}

void findFootings(const PoseProblem& problem, PrintLayout& layout) {
    for (std::size_t i = 0; i < layout.pieces.size(); ++i) {
        std::vector<Footing> footings = footingsOf(problem, layout.frame, layout.pieces, i);
        if (const PrintPiece& piece = layout.pieces[i]; footings.empty() && piece.actor)
            layout.warnings.push_back(
                fmt::format("{} stands on nothing: nobody can hold such a pose; 'fantascope pose' finds others", piece.name));
        layout.footings.insert(layout.footings.end(), std::make_move_iterator(footings.begin()),
                               std::make_move_iterator(footings.end()));
    }
}

// Shifts everything, so that the origin comes to the plate's middle.
void moveAll(PrintLayout& layout, const dvec2& shift) {
    const dvec3 by(shift.x, 0, shift.y);
    layout.frame.stageOrigin -= by / layout.frame.scale;
    for (PrintPiece& piece : layout.pieces)
        for (glm::vec3& v : piece.mesh.vertices) v += glm::vec3(by);
    for (Footing& footing : layout.footings) {
        footing.contact.place += shift;
        for (dvec2& p : footing.contact.outline) p += shift;
        for (dvec3& p : footing.bearing) p += by;
    }
}

// The plate surrounds everything that stands on the floor, and the actors' mass centres.
void findPlate(const PoseProblem& problem, const SceneEnergy& scene, PrintLayout& layout) {
    std::vector<dvec2> points;
    for (const Footing& footing : layout.footings)
        if (footing.ground == 0) points.insert(points.end(), footing.contact.outline.begin(), footing.contact.outline.end());
    for (std::size_t i = 0; i < problem.actors.size(); ++i) {
        const dvec3 centre = layout.frame.inSolid(scene.posed(i).massCentre());
        points.emplace_back(centre.x, centre.z);
    }
    dvec2 least(std::numeric_limits<double>::infinity()), most = -least;
    for (const dvec2& p : points) least = glm::min(least, p), most = glm::max(most, p);
    const dvec2 shift = -0.5 * (least + most);
    moveAll(layout, shift);
    for (dvec2& p : points) p += shift;
    layout.hull = hullOf(points);
}

// Lines to engrave: the arrow to the lamp, and one along the screen.
std::vector<std::vector<dvec2>> marksOn(const std::vector<dvec2>& hull, const PrintFrame& frame, const dvec3& lamp,
                                        double margin) {
    // The arrow points at the lamp, from the middle to the edge.
    const dvec3 light = frame.inSolid(lamp);
    const dvec2 centre = middleOf(hull), toLamp = glm::normalize(dvec2(light.x, light.z) - centre);
    dvec2 middle = centre;
    const double inset = margin - 2 * kMark;
    const auto arrow = partWithin(hull, inset, centre, toLamp, 1e4);
    const dvec2 tip = arrow[1], back = -0.8 * margin * toLamp, side = dvec2(-toLamp.y, toLamp.x) * 0.4 * margin;
    std::vector<std::vector<dvec2>> marks{{arrow[0], tip}, {tip + back + side, tip, tip + back - side}};
    // The line along the screen lies where the screen stands, or at the plate's edge towards it,
    const double screen = frame.inSolid({0, 0, 0}).z;
    double nearest = std::numeric_limits<double>::infinity();
    for (const dvec2& p : hull)
        if (p.y < nearest) nearest = p.y, middle.x = p.x;
    // or as far from that edge as needed for a line long enough to lay a ruler along.
    std::vector<dvec2> line;
    for (double y = std::max(screen, nearest - inset + kMark);; y += kMark) {
        const double share = std::clamp((y - nearest) / std::max(centre.y - nearest, kMark), 0.0, 1.0);
        const auto part = partWithin(hull, inset, {std::lerp(middle.x, centre.x, share), y}, {1, 0}, 1e4);
        if (part.size() == 2) line = part;
        if (y >= centre.y || y == screen || (line.size() == 2 && glm::distance(line[0], line[1]) >= kLine)) break;
    }
    if (line.size() == 2) marks.push_back(line);
    return marks;
}

}  // namespace

std::string PrintLayout::partAt(const PoseProblem& problem, const PrintPiece& piece, const dvec3& place) {
    if (!piece.actor) return piece.name;
    const BodyMesh& skin = *problem.skins[*piece.actor];
    std::size_t nearest = 0;
    for (std::size_t v = 0; v < piece.mesh.vertices.size(); ++v)
        if (glm::distance(dvec3(piece.mesh.vertices[v]), place) < glm::distance(dvec3(piece.mesh.vertices[nearest]), place))
            nearest = v;
    return fmt::format("{}, {}", piece.name, problem.actors[*piece.actor].joints[skin.joints[nearest][0]].name);
}
const PrintPiece& PrintLayout::pieceAt(const dvec3& place) const {
    const PrintPiece* nearest = &pieces[0];
    double least = std::numeric_limits<double>::infinity();
    for (const PrintPiece& piece : pieces)
        for (const glm::vec3& v : piece.mesh.vertices)
            if (const double distance = glm::distance(dvec3(v), place); distance < least) least = distance, nearest = &piece;
    return *nearest;
}

Result<PrintLayout> layOut(const PoseProblem& problem, const SceneEnergy& scene, const Fabrication::Options& options) {
    PrintLayout layout = TRY(placed(problem, scene, options.height));
    findFootings(problem, layout);
    findPlate(problem, scene, layout);
    layout.marks = marksOn(layout.hull, layout.frame, problem.stage.beams[0].light, options.margin);
    return layout;
}

}  // namespace fantascope::theatre
