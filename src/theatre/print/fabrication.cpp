#include "theatre/print/fabrication.h"

#include "theatre/body/simplify.h"
#include "theatre/energy/scene_energy.h"
#include "theatre/mask/convex_outline.h"
#include "theatre/mask/distance_field.h"
#include "theatre/print/voxel_solid.h"
#include "theatre/stage/surroundings.h"

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

namespace fantascope::theatre {
namespace {

using glm::dvec2, glm::dvec3;

// Metres of the stage.
constexpr double kHover = 0.04;  // what stands no higher above the ground was meant to stand on it
constexpr double kLow = 0.01;    // what is no higher throws a shadow that nobody misses
// Millimetres of the print.
constexpr double kPlate = 3, kPlateShare = 0.04;  // its thickness
constexpr double kFirm = 20;  // the area in square millimetres that bears a figure of kFigure well; it grows with its square
constexpr double kFigure = 100;
constexpr double kLeastFlare = 0.8, kMostFlare = 5;  // of a figure of kFigure
constexpr double kFlareSlope = 1.5;                  // its height, of its reach
constexpr double kLine = 30;                         // that is engraved along the screen
constexpr double kMark = 1, kMarkDepth = 0.6;        // of what is engraved
constexpr double kLeastRod = 1;                      // its radius
constexpr std::size_t kCrumb = 64;                   // nodes; what is smaller is lost
constexpr double kMostNodes = 250e6;
constexpr double kFold = 3;  // of the wall: what is thin along less is a fold of the skin
// Of the grid's cells: how far the surface may be off for the sake of fewer triangles, and around
// what it stays as it was.
constexpr double kTolerance = 0.08, kKeptAround = 6;
constexpr int kTries = 5;
constexpr std::size_t kSamples = 50'000;  // of the surface, where the wall behind it is measured
constexpr int kCellsHigh = 280, kCellsInWall = 4;

// In the solid's frame: millimetres, the stage's axes, the floor at y = 0.
struct Piece {
    std::string name;
    std::optional<std::size_t> actor;
    bool isPlatform = false;
    TriangleMesh mesh;
};

class Maker {
public:
    Maker(const PoseProblem& problem, std::span<const double> freedoms, const Fabrication::Options& options,
          const FabricationWatch& watch)
        : problem_(problem), options_(resolved(options)), watch_(watch), scene_(problem) {
        scene_.pose(freedoms);
        scene_.terms();
        hidden_ = signedDistance(scene_.shadow());
    }

    Result<Fabrication> make() {
        TRY(options_.check());
        TRY(placeAll());
        TRY(step(0.02, "contacts"));
        findContacts();
        findPlate();
        TRY(makeGrid());
        TRY(step(0.05, "union"));
        TRY(uniteAll());
        TRY(step(0.30, "walls"));
        tellThin(thicken());
        TRY(step(0.38, "feet"));
        joinContacts();
        thicken();
        TRY(step(0.44, "walls"));
        measureWalls();
        TRY(step(0.48, "plate"));
        addPlate();
        solid_->cutBelow(-options_.plate);  // for the bed, what has sunk through it
        TRY(step(0.50, "what hangs together"));
        joinIslands();
        solid_->fillCavities();
        TRY(step(0.55, "surface"));
        TRY(makeSurface());
        TRY(step(0.92, "shadow"));
        measure();
        return std::move(made_);
    }

private:
    static Fabrication::Options resolved(Fabrication::Options options) {
        if (options.plate == 0) options.plate = std::max(kPlate, kPlateShare * options.height);
        if (options.cell == 0) options.cell = Fabrication::cellFor(options.height, options.wall);
        return options;
    }

    Result<void> step(double share, const char* what) {
        if (watch_.tell) watch_.tell(share, what);
        if (watch_.askStop && watch_.askStop()) return Error("interrupted; nothing is written");
        return {};
    }

    // From the stage's metres, and into the print's frame.
    dvec3 inSolid(const dvec3& p) const { return made_.scale * (p - made_.stageOrigin); }
    static glm::vec3 inPrint(const dvec3& p) { return glm::vec3(p.x, -p.z, p.y); }
    static dvec2 inPrint(const dvec2& xz) { return {xz.x, -xz.y}; }

    Result<void> placeAll() {
        std::vector<Piece> pieces;
        for (std::size_t i = 0; i < problem_.actors.size(); ++i) {
            const auto skin = scene_.skin(i);
            pieces.push_back(
                {fmt::format("actor {}", i + 1), i, false, {{skin.begin(), skin.end()}, problem_.skins[i]->atRest.triangles}});
        }
        const std::vector<SceneEnergy::Thing> things = scene_.things();
        for (const SceneEnergy::Thing& thing : things) {
            const auto& platforms = problem_.stage.platforms;
            const bool isPlatform = std::any_of(platforms.begin(), platforms.end(),
                                                [&](const Stage::Platform& platform) { return platform.name == thing.name; });
            pieces.push_back({isPlatform ? fmt::format("platform '{}'", thing.name) : fmt::format("prop '{}'", thing.name),
                              std::nullopt, isPlatform, thing.mesh});
            if (edgesOf(thing.mesh).empty())
                made_.warnings.push_back(
                    fmt::format("the mesh of prop '{}' is not closed: what an odd number of its faces lies before "
                                "was taken for solid; look at it, or close its holes",
                                thing.name));
        }
        dvec3 least(std::numeric_limits<double>::infinity()), most = -least;
        for (const Piece& piece : pieces)
            for (const glm::vec3& v : piece.mesh.vertices) least = glm::min(least, dvec3(v)), most = glm::max(most, dvec3(v));
        constexpr double kLeastHeight = 0.05;
        if (most.y < kLeastHeight)
            return Error("nothing of the cast is more than 5 cm above the floor; there is nothing to print");
        made_.scale = options_.height / most.y;
        made_.stageOrigin = {0.5 * (least.x + most.x), 0, 0.5 * (least.z + most.z)};
        for (Piece& piece : pieces)
            for (glm::vec3& v : piece.mesh.vertices) v = glm::vec3(inSolid(v));
        pieces_ = std::move(pieces);
        return {};
    }

    // Who has a place, in the solid's frame.
    std::string partAt(const Piece& piece, const dvec3& place) const {
        if (!piece.actor) return piece.name;
        const BodyMesh& skin = *problem_.skins[*piece.actor];
        std::size_t nearest = 0;
        for (std::size_t v = 0; v < piece.mesh.vertices.size(); ++v)
            if (glm::distance(dvec3(piece.mesh.vertices[v]), place) < glm::distance(dvec3(piece.mesh.vertices[nearest]), place))
                nearest = v;
        return fmt::format("{}, {}", piece.name, problem_.actors[*piece.actor].joints[skin.joints[nearest][0]].name);
    }
    const Piece& pieceAt(const dvec3& place) const {
        const Piece* nearest = &pieces_[0];
        double least = std::numeric_limits<double>::infinity();
        for (const Piece& piece : pieces_)
            for (const glm::vec3& v : piece.mesh.vertices)
                if (const double distance = glm::distance(dvec3(v), place); distance < least) least = distance, nearest = &piece;
        return *nearest;
    }

    // Parts of a piece that are low over the ground and hang together along the mesh.
    struct Low {
        const Piece* piece;
        double ground;  // of the stage, mm
        std::vector<dvec3> bearing;
        Fabrication::Contact contact;
    };
    void findContacts() {
        const double s = made_.scale;
        for (const Piece& piece : pieces_) {
            const auto& vertices = piece.mesh.vertices;
            std::vector<double> grounds(vertices.size());
            std::vector<std::uint32_t> group(vertices.size());
            std::iota(group.begin(), group.end(), 0u);
            const auto root = [&](std::uint32_t i) {
                while (group[i] != i) i = group[i] = group[group[i]];
                return i;
            };
            for (std::size_t i = 0; i < vertices.size(); ++i) {
                const dvec3 place = made_.stageOrigin + dvec3(vertices[i]) / s;
                // What has sunk in a little still stands there.
                grounds[i] = piece.isPlatform ? 0 : s * problem_.stage.groundUnder(place + dvec3(0, 0.5 * kHover, 0));
            }
            const auto isLow = [&](std::uint32_t i) { return vertices[i].y - grounds[i] < s * kHover; };
            for (const glm::uvec3& t : piece.mesh.triangles)
                for (int i = 0; i < 3; ++i)
                    if (const std::uint32_t a = t[i], b = t[(i + 1) % 3]; isLow(a) && isLow(b)) group[root(a)] = root(b);
            std::map<std::uint32_t, std::vector<std::uint32_t>> groups;
            for (std::uint32_t i = 0; i < vertices.size(); ++i)
                if (isLow(i)) groups[root(i)].push_back(i);
            double lowestGap = s * kHover;
            for (std::uint32_t i = 0; i < vertices.size(); ++i) lowestGap = std::min(lowestGap, vertices[i].y - grounds[i]);
            for (const auto& [first, members] : groups) {
                std::uint32_t lowest = members[0];
                for (const std::uint32_t i : members)
                    if (vertices[i].y - grounds[i] < vertices[lowest].y - grounds[lowest]) lowest = i;
                const double gap = vertices[lowest].y - grounds[lowest];
                if (gap > std::max(0.0, lowestGap) + s * kLow) continue;  // it stands on something else
                Low low{&piece, grounds[lowest], {}, {}};
                std::vector<dvec2> plan;
                for (const std::uint32_t i : members)
                    if (vertices[i].y - grounds[i] <= std::max(gap, 0.0) + s * kLow && grounds[i] == low.ground) {
                        low.bearing.emplace_back(vertices[i]);
                        plan.emplace_back(vertices[i].x, vertices[i].z);
                    }
                low.contact.outline = hullOf(plan);
                low.contact.area = areaOf(low.contact.outline);
                low.contact.gap = gap;
                low.contact.who = partAt(piece, vertices[lowest]);
                low.contact.place = middleOf(low.contact.outline);
                lows_.push_back(std::move(low));
            }
            const bool stands = std::any_of(lows_.begin(), lows_.end(), [&](const Low& low) { return low.piece == &piece; });
            if (!stands && piece.actor)
                made_.warnings.push_back(
                    fmt::format("{} stands on nothing: nobody can hold such a pose; 'fantascope pose' finds others", piece.name));
        }
    }

    // So that the origin comes to the plate's middle.
    void moveAll(const dvec2& shift) {
        const dvec3 by(shift.x, 0, shift.y);
        made_.stageOrigin -= by / made_.scale;
        for (Piece& piece : pieces_)
            for (glm::vec3& v : piece.mesh.vertices) v += glm::vec3(by);
        for (Low& low : lows_) {
            low.contact.place += shift;
            for (dvec2& p : low.contact.outline) p += shift;
            for (dvec3& p : low.bearing) p += by;
        }
    }

    // Around all that stands on the floor, and what is above it.
    void findPlate() {
        std::vector<dvec2> points;
        for (const Low& low : lows_)
            if (low.ground == 0) points.insert(points.end(), low.contact.outline.begin(), low.contact.outline.end());
        for (std::size_t i = 0; i < problem_.actors.size(); ++i) {
            const dvec3 centre = inSolid(scene_.posed(i).massCentre());
            points.emplace_back(centre.x, centre.z);
        }
        dvec2 least(std::numeric_limits<double>::infinity()), most = -least;
        for (const dvec2& p : points) least = glm::min(least, p), most = glm::max(most, p);
        const dvec2 shift = -0.5 * (least + most);
        moveAll(shift);
        for (dvec2& p : points) p += shift;
        hull_ = hullOf(points);
        // The arrow points at the lamp, from the middle to the edge.
        const dvec3 light = inSolid(problem_.stage.light);
        const dvec2 centre = middleOf(hull_), toLamp = glm::normalize(dvec2(light.x, light.z) - centre);
        dvec2 middle = centre;
        const double inset = options_.margin - 2 * kMark;
        const auto arrow = partWithin(hull_, inset, centre, toLamp, 1e4);
        const dvec2 tip = arrow[1], back = -0.8 * options_.margin * toLamp,
                    side = dvec2(-toLamp.y, toLamp.x) * 0.4 * options_.margin;
        marks_ = {{arrow[0], tip}, {tip + back + side, tip, tip + back - side}};
        // And a line along the screen: where the screen stands, or at the plate's edge towards it.
        const double screen = inSolid({0, 0, 0}).z;
        double nearest = std::numeric_limits<double>::infinity();
        for (const dvec2& p : hull_)
            if (p.y < nearest) nearest = p.y, middle.x = p.x;
        // .. or as far from it as makes the line long enough to lay a rule along.
        std::vector<dvec2> line;
        for (double y = std::max(screen, nearest - inset + kMark);; y += kMark) {
            const double share = std::clamp((y - nearest) / std::max(centre.y - nearest, kMark), 0.0, 1.0);
            const auto part = partWithin(hull_, inset, {std::lerp(middle.x, centre.x, share), y}, {1, 0}, 1e4);
            if (part.size() == 2) line = part;
            if (y >= centre.y || y == screen || (line.size() == 2 && glm::distance(line[0], line[1]) >= kLine)) break;
        }
        if (line.size() == 2) marks_.push_back(line);
    }

    Result<void> makeGrid() {
        made_.cell = options_.cell;
        const double cell = made_.cell, band = 3 * cell,
                     around = band + 4 * cell + std::max(2 * kLeastRod * options_.height / kFigure, options_.wall);
        dvec3 least(std::numeric_limits<double>::infinity()), most = -least;
        for (const Piece& piece : pieces_)
            for (const glm::vec3& v : piece.mesh.vertices) least = glm::min(least, dvec3(v)), most = glm::max(most, dvec3(v));
        for (const dvec2& p : hull_) {
            const double reach = std::max(options_.margin, flareMost());
            least = glm::min(least, dvec3(p.x - reach, 0, p.y - reach)),
            most = glm::max(most, dvec3(p.x + reach, 0, p.y + reach));
        }
        least -= around, most += around;
        // The floor lies between two planes of nodes.
        least.y = -(std::ceil((std::max(options_.plate, -least.y) + around) / cell) + 0.5) * cell;
        if (const double nodes = VoxelSolid::nodesOf({least, most}, cell); nodes > kMostNodes)
            return Error(
                fmt::format("a grid of {:.2f} mm has {:.0f} million nodes here, more than {:.0f}; choose a lower --height or a "
                            "coarser --detail",
                            cell, nodes / 1e6, kMostNodes / 1e6));
        solid_.emplace(VoxelSolid::Box{least, most}, cell, band);
        return {};
    }
    double flareMost() const { return kMostFlare * options_.height / kFigure; }

    Result<void> uniteAll() {
        for (std::size_t i = 0; i < pieces_.size(); ++i) {
            TRY(step(0.05 + 0.25 * static_cast<double>(i) / static_cast<double>(pieces_.size()), "union"));
            solid_->add(pieces_[i].mesh, options_.wall);
        }
        // What is held is held by more than a touch.
        for (std::size_t a = 0; a < problem_.actors.size(); ++a)
            for (const PlacedProp& held : scene_.held(a)) {
                const Body::Point& part = problem_.actors[a].parts[static_cast<std::size_t>(held.prop->holder->part)];
                const dvec3 grip = inSolid(scene_.posed(a).point(part.joint, part.local));
                dvec3 nearest = grip;
                double least = std::numeric_limits<double>::infinity();
                for (const glm::uvec3& t : held.prop->shape->mesh.triangles) {
                    dvec3 middle(0);
                    for (int i = 0; i < 3; ++i) middle += inSolid(held.point(held.prop->shape->mesh.vertices[t[i]])) / 3.0;
                    if (const double distance = glm::distance(middle, grip); distance < least) least = distance, nearest = middle;
                }
                solid_->addRod(grip, nearest, 0.5 * options_.wall);
            }
        solid_->fillCavities();
        return {};
    }

    // What was thinner than a wall, before.
    std::vector<VoxelSolid::Thin> thicken() {
        std::vector<VoxelSolid::Thin> thin = solid_->thinnerThan(options_.wall);
        // A rod from each middle to the nearest few: balls alone would be beads. No farther than a
        // wall: what is thickened would touch there.
        constexpr std::size_t kNeighbours = 3;
        const double reach = options_.wall, radius = 0.5 * options_.wall + 0.25 * made_.cell;
        using Bucket = std::array<int, 3>;
        const auto bucketOf = [&](const dvec3& p) {
            const dvec3 q = glm::floor(p / reach);
            return Bucket{static_cast<int>(q.x), static_cast<int>(q.y), static_cast<int>(q.z)};
        };
        std::map<Bucket, std::vector<dvec3>> buckets;
        for (const VoxelSolid::Thin& at : thin) buckets[bucketOf(at.middle)].push_back(at.middle);
        std::vector<std::pair<double, dvec3>> near;
        for (const VoxelSolid::Thin& at : thin) {
            near = {{0, at.middle}};
            const Bucket own = bucketOf(at.middle);
            for (int i = 0; i < 27; ++i) {
                const auto bucket = buckets.find({own[0] + i % 3 - 1, own[1] + i / 3 % 3 - 1, own[2] + i / 9 - 1});
                if (bucket == buckets.end()) continue;
                for (const dvec3& other : bucket->second)
                    if (const double distance = glm::distance(at.middle, other); distance > 0 && distance <= reach)
                        near.emplace_back(distance, other);
            }
            std::stable_sort(near.begin(), near.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
            for (std::size_t i = 0; i < std::min(near.size(), 1 + kNeighbours); ++i)
                solid_->addRod(at.middle, near[i].second, radius);
        }
        return thin;
    }

    // Of each part, unless it is a mere fold of the skin.
    void tellThin(const std::vector<VoxelSolid::Thin>& thin) {
        std::map<std::string, std::vector<double>> parts;
        for (const VoxelSolid::Thin& at : thin) parts[partAt(pieceAt(at.middle), at.middle)].push_back(at.thickness);
        for (auto& [who, found] : parts) {
            if (static_cast<double>(found.size()) * made_.cell < kFold * options_.wall) continue;
            std::sort(found.begin(), found.end());
            const double middle = found[found.size() / 2];
            made_.thin.push_back({who, middle, options_.height * options_.wall / middle});
        }
    }

    // How far a place is outside what the poses shade, on the spot; negative: hidden in their
    // shadow.
    double seen(const dvec3& p) const {
        const ScreenFrame& frame = problem_.target.frame;
        const dvec3 place = made_.stageOrigin + p / made_.scale;
        const double toLight = problem_.stage.light.z - place.z;
        if (toLight < kLow) return 0;
        const dvec2 pixel = glm::clamp(frame.shadow(place), dvec2(0), dvec2(frame.width() - 1, frame.height() - 1));
        return -double{hidden_.at(static_cast<int>(pixel.x), static_cast<int>(pixel.y))} * frame.pixel() * toLight /
               problem_.stage.light.z * made_.scale;
    }

    void joinContacts() {
        const double s = made_.scale, grow = options_.height / kFigure, firm = kFirm * grow * grow;
        for (Low& low : lows_) {
            const double ground = low.ground, into = ground - 0.5 * options_.plate,
                         radius = std::max(1.5 * made_.cell, 0.25 * options_.wall);
            // What hovers comes down, and what barely touches goes in.
            for (const dvec3& p : low.bearing)
                if (p.y > into)
                    solid_->add(
                        [&](const dvec3& at) {
                            return std::max(
                                {glm::distance(dvec2(at.x, at.z), dvec2(p.x, p.z)) - radius, at.y - p.y, into - at.y});
                        },
                        {{p.x - radius, into, p.z - radius}, {p.x + radius, p.y, p.z + radius}});
            Fabrication::Contact& contact = low.contact;
            dvec2 least(std::numeric_limits<double>::infinity()), most = -least;
            for (const dvec2& q : contact.outline) least = glm::min(least, q), most = glm::max(most, q);
            // Things have few vertices.
            if (!low.piece->actor && contact.gap > 0)
                solid_->add(
                    [&, top = ground + contact.gap + made_.cell](const dvec3& at) {
                        return std::max({distanceTo(contact.outline, dvec2(at.x, at.z)) - radius, at.y - top, into - at.y});
                    },
                    {{least.x - radius, into, least.y - radius}, {most.x + radius, ground + contact.gap, most.y + radius}});
            if (contact.area >= firm) continue;
            // A foot of the print's own: as wide as makes the area firm, and the less the higher;
            // hidden where it is not low.
            const double p = perimeterOf(contact.outline),
                         wanted = (-p + std::sqrt(p * p + 4 * std::numbers::pi * (firm - contact.area))) / (2 * std::numbers::pi);
            const double reach = contact.reinforcedBy = std::clamp(wanted, kLeastFlare * grow, kMostFlare * grow),
                         height = kFlareSlope * reach + std::max(0.0, contact.gap), lowest = s * kLow;
            // The flank's slope and the shadow's edge make the field steeper than 1.
            constexpr double kSteep = 0.5;
            solid_->add(
                [&](const dvec3& at) {
                    const double up = std::clamp((at.y - ground) / height, 0.0, 1.0), wide = reach * (1 - up) * (1 - up);
                    const double flare =
                        std::max({distanceTo(contact.outline, dvec2(at.x, at.z)) - wide, at.y - ground - height, into - at.y});
                    return kSteep * std::max(flare, std::min(at.y - ground - lowest, seen(at)));
                },
                {{least.x - reach, into, least.y - reach}, {most.x + reach, ground + height, most.y + reach}});
        }
    }

    void addPlate() {
        const double t = options_.plate, half = std::max(0.5 * kMark, 1.25 * made_.cell), depth = std::min(kMarkDepth, t / 3);
        dvec2 least(std::numeric_limits<double>::infinity()), most = -least;
        for (const dvec2& p : hull_) least = glm::min(least, p - options_.margin), most = glm::max(most, p + options_.margin);
        solid_->add(
            [&](const dvec3& p) {
                const dvec2 plan(p.x, p.z);
                const double plate = std::max(distanceTo(hull_, plan) - options_.margin, std::abs(p.y + 0.5 * t) - 0.5 * t);
                if (p.y < -depth - 4 * made_.cell) return plate;
                double mark = std::numeric_limits<double>::infinity();
                for (const auto& line : marks_)
                    for (std::size_t i = 0; i + 1 < line.size(); ++i)
                        mark = std::min(mark, distanceTo(line[i], line[i + 1], plan));
                return std::max(plate, -std::max(mark - half, -(p.y + depth)));
            },
            {{least.x, -t, least.y}, {most.x, 0, most.y}});
    }

    // The shortest, but that what of it is not hidden in the poses' shadow counts ten times.
    std::pair<dvec3, dvec3> rodBetween(const std::vector<dvec3>& island, const std::vector<dvec3>& others) const {
        constexpr std::size_t kOfIsland = 300, kOfOthers = 2000;
        constexpr int kSamples = 12;
        constexpr double kSeen = 10;
        std::pair<dvec3, dvec3> best{island[0], others[0]};
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t i = 0; i < island.size(); i += island.size() / kOfIsland + 1)
            for (std::size_t k = 0; k < others.size(); k += others.size() / kOfOthers + 1) {
                const double step = glm::distance(island[i], others[k]) / kSamples;
                double cost = step * kSamples;
                for (int sample = 0; sample < kSamples && cost < least; ++sample)
                    if (seen(glm::mix(island[i], others[k], (sample + 0.5) / kSamples)) > 0) cost += (kSeen - 1) * step;
                if (cost < least) least = cost, best = {island[i], others[k]};
            }
        return best;
    }

    // What does not hang together with the plate is held by a rod.
    void joinIslands() {
        for (;;) {
            std::vector<VoxelSolid::Piece> pieces = solid_->pieces();
            // The plate's: it has the lowest node.
            const auto lowest = [](const VoxelSolid::Piece& piece) {
                double low = std::numeric_limits<double>::infinity();
                for (const dvec3& p : piece.some) low = std::min(low, p.y);
                return low;
            };
            const auto plate = std::min_element(pieces.begin(), pieces.end(),
                                                [&](const auto& a, const auto& b) { return lowest(a) < lowest(b); });
            const auto island = std::find_if(pieces.begin(), pieces.end(), [&](const auto& piece) {
                return piece.number != plate->number && piece.nodes > kCrumb;
            });
            if (island == pieces.end()) {
                for (const auto& piece : pieces)
                    if (piece.number != plate->number) solid_->remove(piece);
                return;
            }
            const auto [from, to] = rodBetween(island->some, plate->some);
            const Piece& piece = pieceAt(from);
            const double length = glm::distance(from, to),
                         radius = std::max(kLeastRod * options_.height / kFigure, 0.5 * options_.wall);
            const dvec3 along = length > 0 ? (to - from) / length : dvec3(0, -1, 0);
            solid_->addRod(from - radius * along, to + radius * along, std::max(radius, 2 * made_.cell));
            made_.rods.push_back({piece.name, length});
            made_.warnings.push_back(
                fmt::format("{} touches nothing that stands: a rod of {:.1f} mm holds it", piece.name, length));
        }
    }

    // Above the plate, whose thickness is known.
    void measureWalls() {
        made_.leastWall = options_.wall;
        std::optional<VoxelSolid::Thin> thinnest;
        for (const VoxelSolid::Thin& thin : solid_->thinnerThan(options_.wall))
            if (thin.middle.y > 0 && (!thinnest || thin.thickness < thinnest->thickness)) thinnest = thin;
        if (!thinnest) return;
        made_.leastWall = thinnest->thickness;
        made_.leastWallAt = partAt(pieceAt(thinnest->middle), thinnest->middle);
    }

    Result<void> makeSurface() {
        TriangleMesh fine = solid_->surface();
        solid_.reset();
        for (glm::vec3& v : fine.vertices) v = inPrint(dvec3(v));
        // Fewer triangles, as long as none runs through another: around those that do the surface
        // stays as fine as it was.
        std::vector<glm::vec3> kept;
        const auto near = static_cast<float>(kKeptAround * made_.cell);
        for (int attempt = 0; attempt <= kTries; ++attempt) {
            TRY(step(0.58 + 0.32 * attempt / kTries, "triangles"));
            made_.mesh = attempt == kTries ? fine : simplifiedWithin(fine, kTolerance * made_.cell, [&](const glm::vec3& place) {
                return std::none_of(kept.begin(), kept.end(), [&](const glm::vec3& k) { return glm::distance(k, place) < near; });
            });
            TRY(step(0.65 + 0.32 * attempt / kTries, "check"));
            made_.check = checkSolid(made_.mesh);
            if (made_.check.isSound()) break;
            for (const std::uint32_t t : made_.check.crossings) kept.push_back(made_.mesh.vertices[made_.mesh.triangles[t].x]);
        }
        if (!made_.check.isSound() || made_.check.pieces != 1)
            return Error("the surface did not become one closed solid; another --detail may do");
        return {};
    }

    // The sheet is drawn for one lamp and one flat screen.
    void sayOfOtherScreens() {
        const Stage& stage = problem_.stage;
        if (const Screen& screen = stage.screenOf(0); screen.isCurved())
            made_.warnings.push_back(fmt::format(
                "the screen is curved: on a flat one the shadow is drawn out to the sides; bend it to a radius of {:.0f} mm, {}",
                made_.scale * std::abs(screen.radius),
                screen.radius > 0 ? "hollow towards the lamp" : "bulging towards the lamp"));
        for (std::size_t beam = 1; beam < stage.beams(); ++beam) {
            const Screen& screen = stage.screenOf(beam);
            const dvec3 light = made_.fromStage(stage.beam(beam).light), foot = made_.fromStage({screen.at.x, 0, screen.at.y});
            made_.warnings.push_back(fmt::format(
                "the sheet and the figures are of the first lamp; lamp {} stands {:.0f} mm to the right of the plate's middle, "
                "{:.0f} mm towards "
                "the first screen and {:.0f} mm high, and its screen goes through {:.0f} mm, {:.0f} mm, turned by {:.0f} degrees",
                beam + 1, light.x, light.y, light.z, foot.x, foot.y, screen.turn * 180 / std::numbers::pi));
        }
    }

    void measure() {
        const ScreenFrame& frame = problem_.target.frame;
        const double s = made_.scale;
        TriangleMesh onStage = made_.mesh;
        for (glm::vec3& v : onStage.vertices) v = glm::vec3(made_.stageOrigin + dvec3(v.x, v.z, -v.y) / s);
        made_.shadow = BitMask(frame.width(), frame.height());
        addShadow(frame, onStage, made_.shadow);
        BitMask poses = scene_.shadow(), target = problem_.target.mask;
        // The plate's shadow begins below the floor.
        const int floor = static_cast<int>(std::floor(frame.pixelAt(0, 0).y + 1e-6));
        for (BitMask* const mask : {&made_.shadow, &poses, &target}) {
            mask->keep(0, 0, frame.width(), std::clamp(floor, 0, frame.height()));
            cutToLit(problem_.stage, frame, *mask);
        }
        made_.shadowIou = intersectionOverUnion(made_.shadow, poses);
        made_.targetIou = intersectionOverUnion(made_.shadow, target);
        made_.posesIou = intersectionOverUnion(poses, target);

        const std::size_t every = made_.mesh.triangles.size() / kSamples + 1;
        const std::vector<double> walls = thicknesses(made_.mesh, every);
        double all = 0, below = 0;
        for (std::size_t i = 0; i < walls.size(); ++i) {
            const glm::uvec3& c = made_.mesh.triangles[i * every];
            const dvec3 a = made_.mesh.vertices[c.x], b = made_.mesh.vertices[c.y], d = made_.mesh.vertices[c.z];
            const double area = glm::length(glm::cross(b - a, d - a));
            all += area;
            if (walls[i] < options_.wall) below += area;
        }
        made_.shareBelowWall = below / all;

        made_.light = made_.fromStage(problem_.stage.light);
        made_.screen = made_.fromStage({0, 0, 0}).y;
        sayOfOtherScreens();
        constexpr int kRound = 32;
        std::vector<dvec2> outline;
        for (const dvec2& p : hull_)
            for (int i = 0; i < kRound; ++i) {
                const double turn = 2 * std::numbers::pi * i / kRound;
                outline.push_back(inPrint(p) + options_.margin * dvec2(std::cos(turn), std::sin(turn)));
            }
        made_.plate = hullOf(outline);
        made_.thickness = options_.plate;
        for (const auto& line : marks_) {
            auto& mark = made_.marks.emplace_back();
            for (const dvec2& p : line) mark.push_back(inPrint(p));
        }
        for (Low& low : lows_) {
            low.contact.place = inPrint(low.contact.place);
            for (dvec2& p : low.contact.outline) p = inPrint(p);
            made_.contacts.push_back(std::move(low.contact));
        }
    }

    const PoseProblem& problem_;
    const Fabrication::Options options_;
    const FabricationWatch& watch_;
    SceneEnergy scene_;
    std::vector<Piece> pieces_;
    std::vector<Low> lows_;
    std::vector<dvec2> hull_;                // of the plate, (x, z)
    std::vector<std::vector<dvec2>> marks_;  // (x, z)
    std::optional<VoxelSolid> solid_;
    GreyImage hidden_;  // how deep in the poses' shadow, pixels
    Fabrication made_;
};

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

Result<Fabrication> fabricate(const PoseProblem& problem, std::span<const double> freedoms, const Fabrication::Options& options,
                              const FabricationWatch& watch) {
    return Maker(problem, freedoms, options, watch).make();
}

}  // namespace fantascope::theatre
