#include "theatre/print/print_solid.h"

#include "theatre/mask/convex_outline.h"
#include "theatre/mask/distance_field.h"

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

namespace fantascope::theatre {
namespace {

using glm::dvec2, glm::dvec3;

constexpr double kLow = kPrintedLow, kMark = kPrintedMark, kFigure = kPrintedFigure;
// Millimetres of the print.
constexpr double kFirm = 20;  // square millimetres that bear a figure of height kFigure well; grows with the square of the height
constexpr double kLeastFlare = 0.8, kMostFlare = 5;  // reach of a foot, for a figure of height kFigure
constexpr double kFlareSlope = 1.5;                  // height of a foot, in units of its reach
constexpr double kMarkDepth = 0.6;                   // of engraved lines
constexpr double kLeastRod = 1;                      // radius of a rod, for a figure of height kFigure
constexpr std::size_t kCrumb = 64;                   // nodes; smaller pieces are removed
constexpr double kMostNodes = 250e6;
constexpr double kFold = 3;  // in walls: a part that is thin over a shorter length is a fold of the skin

class SolidMaker {
public:
    SolidMaker(const PoseProblem& problem, const SceneEnergy& scene, const PrintLayout& layout,
               const Fabrication::Options& options, const PrintStep& step)
        : problem_(problem), scene_(scene), layout_(layout), options_(options), step_(step) {
        hidden_ = signedDistance(scene.shadow());
    }

    Result<PrintSolid> make() {
        TRY(makeGrid());
        TRY(step_(0.05, "union"));
        TRY(uniteAll());
        TRY(step_(0.30, "walls"));
        tellThin(thicken());
        TRY(step_(0.38, "feet"));
        joinContacts();
        thicken();
        TRY(step_(0.44, "walls"));
        measureWalls();
        TRY(step_(0.48, "plate"));
        addPlate();
        solid_->cutBelow(-options_.plate);  // removes parts that have sunk through the plate, for the printer's bed
        TRY(step_(0.50, "connected pieces"));
        joinIslands();
        solid_->fillCavities();
        return PrintSolid{std::move(*solid_), std::move(thin_),     std::move(reinforcedBy_),
                          std::move(rods_),   std::move(warnings_), wall_,
                          std::move(wallAt_)};
    }

private:
    Result<void> makeGrid() {
        const double cell = options_.cell, band = 3 * cell,
                     around = band + 4 * cell + std::max(2 * kLeastRod * options_.height / kFigure, options_.wall);
        dvec3 least(std::numeric_limits<double>::infinity()), most = -least;
        for (const PrintPiece& piece : layout_.pieces)
            for (const glm::vec3& v : piece.mesh.vertices) least = glm::min(least, dvec3(v)), most = glm::max(most, dvec3(v));
        for (const dvec2& p : layout_.hull) {
            const double reach = std::max(options_.margin, flareMost());
            least = glm::min(least, dvec3(p.x - reach, 0, p.y - reach)),
            most = glm::max(most, dvec3(p.x + reach, 0, p.y + reach));
        }
        least -= around, most += around;
        // The grid is placed so that the floor lies between two planes of nodes.
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
        for (std::size_t i = 0; i < layout_.pieces.size(); ++i) {
            TRY(step_(0.05 + 0.25 * static_cast<double>(i) / static_cast<double>(layout_.pieces.size()), "union"));
            solid_->add(layout_.pieces[i].mesh, options_.wall);
        }
        // A rod joins each held prop to its holder, since a touch alone would be too weak.
        for (std::size_t a = 0; a < problem_.actors.size(); ++a)
            for (const PlacedProp& held : scene_.held(a)) {
                const Body::Point& part = problem_.actors[a].parts[static_cast<std::size_t>(held.prop->holder->part)];
                const dvec3 grip = layout_.frame.inSolid(scene_.posed(a).point(part.joint, part.local));
                dvec3 nearest = grip;
                double least = std::numeric_limits<double>::infinity();
                for (const glm::uvec3& t : held.prop->shape->mesh.triangles) {
                    dvec3 middle(0);
                    for (int i = 0; i < 3; ++i)
                        middle += layout_.frame.inSolid(held.point(held.prop->shape->mesh.vertices[t[i]])) / 3.0;
                    if (const double distance = glm::distance(middle, grip); distance < least) least = distance, nearest = middle;
                }
                solid_->addRod(grip, nearest, 0.5 * options_.wall);
            }
        solid_->fillCavities();
        return {};
    }

    // Thickens parts thinner than a wall, and gives them as they were before.
    std::vector<VoxelSolid::Thin> thicken() {
        std::vector<VoxelSolid::Thin> thin = solid_->thinnerThan(options_.wall);
        // A rod goes from each middle to the nearest few, since balls alone would look like beads.
        // Rods are no longer than a wall is thick; at that distance the thickened parts touch
        // anyway.
        constexpr std::size_t kNeighbours = 3;
        const double reach = options_.wall, radius = 0.5 * options_.wall + 0.25 * options_.cell;
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

    // Reports each thin part, unless it is only a fold of the skin.
    void tellThin(const std::vector<VoxelSolid::Thin>& thin) {
        std::map<std::string, std::vector<double>> parts;
        for (const VoxelSolid::Thin& at : thin)
            parts[PrintLayout::partAt(problem_, layout_.pieceAt(at.middle), at.middle)].push_back(at.thickness);
        for (auto& [who, found] : parts) {
            if (static_cast<double>(found.size()) * options_.cell < kFold * options_.wall) continue;
            std::sort(found.begin(), found.end());
            const double middle = found[found.size() / 2];
            thin_.push_back({who, middle, options_.height * options_.wall / middle});
        }
    }

    // The distance of a place outside the poses' shadow volume, mm of the print. Negative: hidden
    // in their shadow.
    double seen(const dvec3& p) const {
        const ScreenFrame& frame = problem_.targets[0].frame;
        const dvec3 place = layout_.frame.onStage(p);
        const double toLight = problem_.stage.beams[0].light.z - place.z;
        if (toLight < kLow) return 0;
        const dvec2 pixel = glm::clamp(frame.shadow(place), dvec2(0), dvec2(frame.width() - 1, frame.height() - 1));
        return -double{hidden_.at(static_cast<int>(pixel.x), static_cast<int>(pixel.y))} * frame.pixel() * toLight /
               problem_.stage.beams[0].light.z * layout_.frame.scale;
    }

    void joinContacts() {
        const double grow = options_.height / kFigure, firm = kFirm * grow * grow;
        for (const Footing& footing : layout_.footings) {
            const double ground = footing.ground, into = ground - 0.5 * options_.plate,
                         radius = std::max(1.5 * options_.cell, 0.25 * options_.wall);
            // Columns join hovering parts to the ground, and sink parts that barely touch into it.
            for (const dvec3& p : footing.bearing)
                if (p.y > into)
                    solid_->add(
                        [&](const dvec3& at) {
                            return std::max(
                                {glm::distance(dvec2(at.x, at.z), dvec2(p.x, p.z)) - radius, at.y - p.y, into - at.y});
                        },
                        {{p.x - radius, into, p.z - radius}, {p.x + radius, p.y, p.z + radius}});
            const Fabrication::Contact& contact = footing.contact;
            dvec2 least(std::numeric_limits<double>::infinity()), most = -least;
            for (const dvec2& q : contact.outline) least = glm::min(least, q), most = glm::max(most, q);
            // A thing has too few vertices for columns, so its whole outline is extended down.
            if (!layout_.pieces[footing.piece].actor && contact.gap > 0)
                solid_->add(
                    [&, top = ground + contact.gap + options_.cell](const dvec3& at) {
                        return std::max({distanceTo(contact.outline, dvec2(at.x, at.z)) - radius, at.y - top, into - at.y});
                    },
                    {{least.x - radius, into, least.y - radius}, {most.x + radius, ground + contact.gap, most.y + radius}});
            const double reach = contact.area < firm ? reinforce(footing, firm) : 0;
            reinforcedBy_.push_back(reach);
        }
    }

    // Adds a foot around a contact. It is wide enough to make the area firm, and tapers upwards.
    // Its upper part is added only where the poses' shadow hides it. Gives how far it reaches.
    double reinforce(const Footing& footing, double firm) {
        const double ground = footing.ground, into = ground - 0.5 * options_.plate, grow = options_.height / kFigure;
        const Fabrication::Contact& contact = footing.contact;
        dvec2 least(std::numeric_limits<double>::infinity()), most = -least;
        for (const dvec2& q : contact.outline) least = glm::min(least, q), most = glm::max(most, q);
        const double p = perimeterOf(contact.outline),
                     wanted = (-p + std::sqrt(p * p + 4 * std::numbers::pi * (firm - contact.area))) / (2 * std::numbers::pi);
        const double reach = std::clamp(wanted, kLeastFlare * grow, kMostFlare * grow),
                     height = kFlareSlope * reach + std::max(0.0, contact.gap), lowest = layout_.frame.scale * kLow;
        // The flank's slope and the shadow's edge make the field steeper than 1, so it is scaled
        // down.
        constexpr double kSteep = 0.5;
        solid_->add(
            [&](const dvec3& at) {
                const double up = std::clamp((at.y - ground) / height, 0.0, 1.0), wide = reach * (1 - up) * (1 - up);
                const double flare =
                    std::max({distanceTo(contact.outline, dvec2(at.x, at.z)) - wide, at.y - ground - height, into - at.y});
                return kSteep * std::max(flare, std::min(at.y - ground - lowest, seen(at)));
            },
            {{least.x - reach, into, least.y - reach}, {most.x + reach, ground + height, most.y + reach}});
        return reach;
    }

    void addPlate() {
        const double t = options_.plate, half = std::max(0.5 * kMark, 1.25 * options_.cell), depth = std::min(kMarkDepth, t / 3);
        dvec2 least(std::numeric_limits<double>::infinity()), most = -least;
        for (const dvec2& p : layout_.hull)
            least = glm::min(least, p - options_.margin), most = glm::max(most, p + options_.margin);
        solid_->add(
            [&](const dvec3& p) {
                const dvec2 plan(p.x, p.z);
                const double plate =
                    std::max(distanceTo(layout_.hull, plan) - options_.margin, std::abs(p.y + 0.5 * t) - 0.5 * t);
                if (p.y < -depth - 4 * options_.cell) return plate;
                double mark = std::numeric_limits<double>::infinity();
                for (const auto& line : layout_.marks)
                    for (std::size_t i = 0; i + 1 < line.size(); ++i)
                        mark = std::min(mark, distanceTo(line[i], line[i + 1], plan));
                return std::max(plate, -std::max(mark - half, -(p.y + depth)));
            },
            {{least.x, -t, least.y}, {most.x, 0, most.y}});
    }

    // The shortest rod, where a length that the poses' shadow does not hide counts ten times.
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

    // Joins each piece that is not connected to the plate by a rod. Crumbs are removed.
    void joinIslands() {
        for (;;) {
            std::vector<VoxelSolid::Piece> pieces = solid_->pieces();
            // The piece with the lowest node is the plate's.
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
            const PrintPiece& piece = layout_.pieceAt(from);
            const double length = glm::distance(from, to),
                         radius = std::max(kLeastRod * options_.height / kFigure, 0.5 * options_.wall);
            const dvec3 along = length > 0 ? (to - from) / length : dvec3(0, -1, 0);
            solid_->addRod(from - radius * along, to + radius * along, std::max(radius, 2 * options_.cell));
            rods_.push_back({piece.name, length});
            warnings_.push_back(fmt::format("{} touches nothing that stands: a rod of {:.1f} mm holds it", piece.name, length));
        }
    }

    // Finds the thinnest wall above the plate. The plate's own thickness is known.
    void measureWalls() {
        wall_ = options_.wall;
        std::optional<VoxelSolid::Thin> thinnest;
        for (const VoxelSolid::Thin& thin : solid_->thinnerThan(options_.wall))
            if (thin.middle.y > 0 && (!thinnest || thin.thickness < thinnest->thickness)) thinnest = thin;
        if (!thinnest) return;
        wall_ = thinnest->thickness;
        wallAt_ = PrintLayout::partAt(problem_, layout_.pieceAt(thinnest->middle), thinnest->middle);
    }

    const PoseProblem& problem_;
    const SceneEnergy& scene_;
    const PrintLayout& layout_;
    const Fabrication::Options& options_;
    const PrintStep& step_;
    GreyImage hidden_;  // depth in the poses' shadow, pixels
    std::optional<VoxelSolid> solid_;
    std::vector<Fabrication::ThinPart> thin_;
    std::vector<double> reinforcedBy_;
    std::vector<Fabrication::Rod> rods_;
    std::vector<std::string> warnings_;
    double wall_ = 0;
    std::string wallAt_;
};

}  // namespace

Result<PrintSolid> makeSolid(const PoseProblem& problem, const SceneEnergy& scene, const PrintLayout& layout,
                             const Fabrication::Options& options, const PrintStep& step) {
    return SolidMaker(problem, scene, layout, options, step).make();
}

}  // namespace fantascope::theatre
