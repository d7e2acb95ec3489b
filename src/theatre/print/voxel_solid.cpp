#include "theatre/print/voxel_solid.h"

#include "theatre/body/body_mesh.h"
#include "theatre/body/implicit_surface.h"
#include "theatre/body/triangle.h"

#include "core/disjoint_sets.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <unordered_map>
#include <utility>

namespace fantascope::theatre {
namespace {

using glm::dvec3;

constexpr float kFar = std::numeric_limits<float>::max();
// In cells: the surface is kept at least this far from a node, so that no triangle is lost to
// rounding; and values farther than this are ignored.
constexpr double kNearest = 0.1, kFarthest = 1.75;

double distanceToSegment(const dvec3& p, const dvec3& a, const dvec3& b) {
    const dvec3 along = b - a;
    const double length2 = glm::dot(along, along);
    const double share = length2 > 0 ? std::clamp(glm::dot(p - a, along) / length2, 0.0, 1.0) : 0;
    return glm::distance(p, a + share * along);
}

}  // namespace

VoxelSolid::VoxelSolid(const Box& within, double cell, double band) : least_(within.least), cell_(cell), band_(band) {
    for (int i = 0; i < 3; ++i) {
        const auto axis = static_cast<std::size_t>(i);
        count_[axis] = static_cast<int>(std::ceil((within.most[i] - within.least[i]) / cell)) + 1;
        blockCount_[axis] = count_[axis] / kBlock + 1;
    }
    inside_.assign(index({0, 0, count_[2]}), 0);
    block_.assign(static_cast<std::size_t>(blockCount_[0]) * static_cast<std::size_t>(blockCount_[1]) *
                      static_cast<std::size_t>(blockCount_[2]),
                  -1);
}

double VoxelSolid::nodesOf(const Box& within, double cell) {
    const dvec3 counts = glm::ceil((within.most - within.least) / cell) + 1.0;
    return counts.x * counts.y * counts.z;
}

std::array<VoxelSolid::Node, 2> VoxelSolid::nodesIn(const Box& box) const {
    std::array<Node, 2> nodes;
    for (int i = 0; i < 3; ++i) {
        const auto axis = static_cast<std::size_t>(i);
        nodes[0][axis] = std::max(0, static_cast<int>(std::floor((box.least[i] - least_[i]) / cell_)));
        nodes[1][axis] = std::min(count_[axis] - 1, static_cast<int>(std::ceil((box.most[i] - least_[i]) / cell_)));
    }
    return nodes;
}

std::size_t VoxelSolid::blockOf(const Node& node) const {
    return (static_cast<std::size_t>(node[2] / kBlock) * static_cast<std::size_t>(blockCount_[1]) +
            static_cast<std::size_t>(node[1] / kBlock)) *
               static_cast<std::size_t>(blockCount_[0]) +
           static_cast<std::size_t>(node[0] / kBlock);
}

const float* VoxelSolid::find(const Node& node) const {
    const std::int32_t block = block_[blockOf(node)];
    return block < 0 ? nullptr : &values_[static_cast<std::size_t>(block)][inBlock(node)];
}

float* VoxelSolid::find(const Node& node) { return const_cast<float*>(std::as_const(*this).find(node)); }

float& VoxelSolid::make(const Node& node) {
    if (float* const there = find(node)) return *there;
    block_[blockOf(node)] = static_cast<std::int32_t>(values_.size());
    values_.emplace_back().fill(kFar);
    return *find(node);
}

// Unites a node with the solid so far: the distance to a union is the minimum of the distances to
// its parts.
void VoxelSolid::unite(const Node& node, double distance) {
    std::uint8_t& inside = inside_[index(node)];
    if (distance >= band_) return;
    if (distance <= -band_) {
        if (float* const there = find(node)) *there = static_cast<float>(-band_);
        inside = 1;
        return;
    }
    float& value = make(node);
    if (inside != 0 && value == kFar) value = static_cast<float>(-band_);  // deep in another part
    value = std::min(value, static_cast<float>(distance));
    if (distance < 0) inside = 1;
}

double VoxelSolid::value(const Node& node) const {
    const float* const there = find(node);
    const double size = there == nullptr || *there == kFar ? band_ : std::abs(double{*there});
    return inside_[index(node)] != 0 ? -size : size;
}

// Trilinear interpolation between the nodes.
double VoxelSolid::at(const dvec3& point) const {
    const dvec3 wanted = (point - least_) / cell_;
    Node node;
    double share[3];
    for (int i = 0; i < 3; ++i) {
        const auto axis = static_cast<std::size_t>(i);
        node[axis] = std::clamp(static_cast<int>(std::floor(wanted[i])), 0, count_[axis] - 2);
        share[i] = std::clamp(wanted[i] - node[axis], 0.0, 1.0);
    }
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const int dx = corner & 1, dy = corner >> 1 & 1, dz = corner >> 2;
        const double weight =
            (dx != 0 ? share[0] : 1 - share[0]) * (dy != 0 ? share[1] : 1 - share[1]) * (dz != 0 ? share[2] : 1 - share[2]);
        if (weight > 0) sum += weight * value({node[0] + dx, node[1] + dy, node[2] + dz});
    }
    return sum;
}

// Gives a vote to each node of a box that is inside along an axis: by the winding number (`winds`),
// or by an odd number of triangles before it.
void VoxelSolid::vote(const TriangleMesh& mesh, int axis, bool winds, const std::array<Node, 2>& box,
                      std::vector<std::uint8_t>& votes) const {
    struct Crossing {
        int v, u, before, turn;
    };
    std::vector<Crossing> crossings;
    const int uAxis = (axis + 1) % 3, vAxis = (axis + 2) % 3;
    const auto along = static_cast<std::size_t>(axis), u = static_cast<std::size_t>(uAxis), v = static_cast<std::size_t>(vAxis);
    for (const glm::uvec3& triangle : mesh.triangles) {
        dvec3 corners[3];
        for (int i = 0; i < 3; ++i) corners[i] = (dvec3(mesh.vertices[triangle[i]]) - least_) / cell_;
        const dvec3 low = glm::min(glm::min(corners[0], corners[1]), corners[2]),
                    high = glm::max(glm::max(corners[0], corners[1]), corners[2]);
        for (int j = std::max(box[0][v], static_cast<int>(std::ceil(low[vAxis])));
             j <= std::min(box[1][v], static_cast<int>(std::floor(high[vAxis]))); ++j)
            for (int i = std::max(box[0][u], static_cast<int>(std::ceil(low[uAxis])));
                 i <= std::min(box[1][u], static_cast<int>(std::floor(high[uAxis]))); ++i) {
                glm::dvec2 flat[3];
                for (int k = 0; k < 3; ++k) flat[k] = {corners[k][uAxis] - i, corners[k][vAxis] - j};
                const int side = sideOf(flat[1], flat[2]);
                if (side == 0 || sideOf(flat[2], flat[0]) != side || sideOf(flat[0], flat[1]) != side) continue;
                double shares[3], all = 0, at = 0;
                for (int k = 0; k < 3; ++k) {
                    const glm::dvec2 a = flat[(k + 1) % 3], b = flat[(k + 2) % 3];
                    all += shares[k] = a.y * b.x - a.x * b.y;
                }
                if (all == 0) continue;
                for (int k = 0; k < 3; ++k) at += shares[k] / all * corners[k][axis];
                crossings.push_back({j, i, static_cast<int>(std::ceil(at)), side});
            }
    }
    std::sort(crossings.begin(), crossings.end(),
              [](const Crossing& a, const Crossing& b) { return std::tie(a.v, a.u, a.before) < std::tie(b.v, b.u, b.before); });
    const std::size_t wide = static_cast<std::size_t>(box[1][0] - box[0][0] + 1),
                      high = static_cast<std::size_t>(box[1][1] - box[0][1] + 1);
    for (std::size_t c = 0; c < crossings.size();) {
        const Crossing& first = crossings[c];
        int turns = 0;
        std::size_t next = c;
        for (; next < crossings.size() && crossings[next].v == first.v && crossings[next].u == first.u; ++next) {
            turns += crossings[next].turn;
            const bool isInside = winds ? turns != 0 : (next - c) % 2 == 0;
            if (!isInside || next + 1 == crossings.size() || crossings[next + 1].v != first.v || crossings[next + 1].u != first.u)
                continue;
            for (int i = std::max(crossings[next].before, box[0][along]);
                 i < std::min(crossings[next + 1].before, box[1][along] + 1); ++i) {
                Node node;
                node[along] = i, node[u] = first.u, node[v] = first.v;
                ++votes[(static_cast<std::size_t>(node[2] - box[0][2]) * high + static_cast<std::size_t>(node[1] - box[0][1])) *
                            wide +
                        static_cast<std::size_t>(node[0] - box[0][0])];
            }
        }
        c = next;
    }
}

void VoxelSolid::add(const TriangleMesh& mesh, double sheet) {
    if (mesh.triangles.empty()) return;
    dvec3 least(std::numeric_limits<double>::infinity()), most = -least;
    for (const glm::vec3& vertex : mesh.vertices) least = glm::min(least, dvec3(vertex)), most = glm::max(most, dvec3(vertex));
    const double reach = band_ + 0.5 * sheet;
    const auto box = nodesIn({least - reach, most + reach});
    const std::size_t wide = static_cast<std::size_t>(box[1][0] - box[0][0] + 1),
                      high = static_cast<std::size_t>(box[1][1] - box[0][1] + 1),
                      deep = static_cast<std::size_t>(box[1][2] - box[0][2] + 1);
    std::vector<std::uint8_t> votes(wide * high * deep, 0);
    const bool isClosed = !edgesOf(mesh).empty();
    for (int axis = 0; axis < (isClosed ? 1 : 3); ++axis) vote(mesh, axis, isClosed, box, votes);
    const int needed = isClosed ? 1 : 2;

    const auto at = [&](const Node& node) {
        return (static_cast<std::size_t>(node[2] - box[0][2]) * high + static_cast<std::size_t>(node[1] - box[0][1])) * wide +
               static_cast<std::size_t>(node[0] - box[0][0]);
    };
    const auto isBehind = [&](const dvec3& a, const dvec3& b, const dvec3& c) {
        const dvec3 normal = glm::cross(b - a, c - a), middle = (a + b + c) / 3.0;
        if (glm::length(normal) == 0) return true;
        for (const double side : {-1.0, 1.0}) {  // an open mesh may be inside out
            const dvec3 wanted = glm::round((middle + side * cell_ * glm::normalize(normal) - least_) / cell_);
            const Node node{static_cast<int>(wanted.x), static_cast<int>(wanted.y), static_cast<int>(wanted.z)};
            if (votes[at(node)] >= needed) return true;
        }
        return false;
    };
    // Unsigned distances of the nodes around each triangle. Sheets are united at once.
    std::vector<float> distances(votes.size(), kFar);
    for (const glm::uvec3& triangle : mesh.triangles) {
        const dvec3 a = mesh.vertices[triangle.x], b = mesh.vertices[triangle.y], c = mesh.vertices[triangle.z];
        const bool isSheet = !isBehind(a, b, c);
        const double near = isSheet ? reach : band_;
        const auto around = nodesIn({glm::min(glm::min(a, b), c) - near, glm::max(glm::max(a, b), c) + near});
        for (int z = around[0][2]; z <= around[1][2]; ++z)
            for (int y = around[0][1]; y <= around[1][1]; ++y)
                for (int x = around[0][0]; x <= around[1][0]; ++x) {
                    const Node node{x, y, z};
                    const double distance = glm::distance(place(node), nearestOf(place(node), a, b, c));
                    distances[at(node)] = std::min(distances[at(node)], static_cast<float>(distance));
                    if (isSheet) unite(node, distance - 0.5 * sheet);
                }
    }
    for (int z = box[0][2]; z <= box[1][2]; ++z)
        for (int y = box[0][1]; y <= box[1][1]; ++y)
            for (int x = box[0][0]; x <= box[1][0]; ++x) {
                const Node node{x, y, z};
                const double distance = std::min(double{distances[at(node)]}, band_);
                if (votes[at(node)] >= needed)
                    unite(node, -std::max(distance, kNearest * cell_));
                else if (distance < band_)
                    unite(node, distance);
            }
}

void VoxelSolid::add(const Field& field, const Box& around) {
    const auto box = nodesIn({around.least - band_, around.most + band_});
    for (int z = box[0][2]; z <= box[1][2]; ++z)
        for (int y = box[0][1]; y <= box[1][1]; ++y)
            for (int x = box[0][0]; x <= box[1][0]; ++x) unite({x, y, z}, field(place({x, y, z})));
}

void VoxelSolid::addRod(const dvec3& from, const dvec3& to, double radius) {
    add([&](const dvec3& p) { return distanceToSegment(p, from, to) - radius; },
        {glm::min(from, to) - radius, glm::max(from, to) + radius});
}

void VoxelSolid::cutBelow(double height) {
    for (int z = 0; z < count_[2]; ++z)
        for (int y = 0; y < count_[1]; ++y) {
            const double cut = height - place({0, y, z}).y;
            if (cut <= -band_) break;
            for (int x = 0; x < count_[0]; ++x) {
                const Node node{x, y, z};
                std::uint8_t& inside = inside_[index(node)];
                if (inside == 0 && find(node) == nullptr) continue;
                const double there = std::max(value(node), cut);
                make(node) = static_cast<float>(there);
                inside = there < 0 ? 1 : 0;
            }
        }
}

// Nodes are connected along the edges of the tetrahedra: by a step along one or more axes, all of
// the same sign.
VoxelSolid::Runs VoxelSolid::runsOf(bool inside) const {
    Runs all;
    DisjointSets joined;
    const auto ny = static_cast<std::size_t>(count_[1]);
    const auto join = [&](std::size_t row, std::size_t from, std::size_t to) {
        std::size_t other = all.rows[row];
        const std::size_t end = all.rows[row + 1];
        for (std::size_t i = from; i < to; ++i) {
            const Run& run = all.runs[i];
            while (other < end && all.runs[other].to + 1 <= run.from) ++other;
            for (std::size_t o = other; o < end && all.runs[o].from < run.to; ++o) joined.join(i, o);
        }
    };
    for (int z = 0; z < count_[2]; ++z)
        for (int y = 0; y < count_[1]; ++y) {
            const std::size_t first = all.runs.size();
            all.rows.push_back(first);
            const std::uint8_t* const row = &inside_[index({0, y, z})];
            for (int x = 0; x < count_[0];) {
                if ((row[x] != 0) != inside) {
                    ++x;
                    continue;
                }
                const int from = x;
                while (x < count_[0] && (row[x] != 0) == inside) ++x;
                joined.add();
                all.runs.push_back({from, x, 0});
            }
            const std::size_t own = all.rows.size() - 1, end = all.runs.size();
            if (y > 0) join(own - 1, first, end);
            if (z > 0) join(own - ny, first, end);
            if (y > 0 && z > 0) join(own - ny - 1, first, end);
        }
    all.rows.push_back(all.runs.size());
    for (std::size_t i = 0; i < all.runs.size(); ++i) all.runs[i].component = static_cast<std::uint32_t>(joined.root(i));
    return all;
}

void VoxelSolid::fillCavities() {
    const Runs air = runsOf(false);
    const std::uint32_t outside = air.runs[0].component;  // the grid's first node is outside
    for (std::size_t row = 0; row + 1 < air.rows.size(); ++row)
        for (std::size_t i = air.rows[row]; i < air.rows[row + 1]; ++i) {
            const Run& run = air.runs[i];
            if (run.component == outside) continue;
            const int y = static_cast<int>(row) % count_[1], z = static_cast<int>(row) / count_[1];
            for (int x = run.from; x < run.to; ++x) {
                inside_[index({x, y, z})] = 1;
                if (float* const value = find({x, y, z})) *value = static_cast<float>(-band_);
            }
        }
}

std::vector<VoxelSolid::Piece> VoxelSolid::pieces() {
    const Runs solid = runsOf(true);
    std::unordered_map<std::uint32_t, std::size_t> known;
    std::vector<Piece> pieces;
    for (const Run& run : solid.runs) {
        const auto [found, isNew] = known.try_emplace(run.component, pieces.size());
        if (isNew) pieces.emplace_back().number = run.component;
        pieces[found->second].nodes += static_cast<std::uint64_t>(run.to - run.from);
    }
    // The ends of runs lie next to the surface. If there are many, every n-th run is taken.
    std::vector<std::size_t> runs(pieces.size(), 0), seen(pieces.size(), 0);
    for (const Run& run : solid.runs) ++runs[known[run.component]];
    for (std::size_t row = 0; row + 1 < solid.rows.size(); ++row)
        for (std::size_t i = solid.rows[row]; i < solid.rows[row + 1]; ++i) {
            const Run& run = solid.runs[i];
            const std::size_t piece = known[run.component];
            if (seen[piece]++ % (2 * runs[piece] / kSome + 1) != 0) continue;
            const int y = static_cast<int>(row) % count_[1], z = static_cast<int>(row) / count_[1];
            pieces[piece].some.push_back(place({run.from, y, z}));
            pieces[piece].some.push_back(place({run.to - 1, y, z}));
        }
    std::stable_sort(pieces.begin(), pieces.end(), [](const Piece& a, const Piece& b) { return a.nodes > b.nodes; });
    return pieces;
}

void VoxelSolid::remove(const Piece& piece) {
    const Runs solid = runsOf(true);
    for (std::size_t row = 0; row + 1 < solid.rows.size(); ++row)
        for (std::size_t i = solid.rows[row]; i < solid.rows[row + 1]; ++i)
            if (const Run& run = solid.runs[i]; run.component == piece.number)
                for (int x = run.from; x < run.to; ++x)
                    inside_[index({x, static_cast<int>(row) % count_[1], static_cast<int>(row) / count_[1]})] = 0;
}

TriangleMesh VoxelSolid::surface() const {
    TetrahedraSurface surface;
    for (int z = 0; z + 1 < count_[2]; ++z)
        for (int y = 0; y + 1 < count_[1]; ++y) {
            const std::uint8_t* const rows[4] = {&inside_[index({0, y, z})], &inside_[index({0, y + 1, z})],
                                                 &inside_[index({0, y, z + 1})], &inside_[index({0, y + 1, z + 1})]};
            for (int x = 0; x + 1 < count_[0]; ++x) {
                int inside = 0;
                for (const std::uint8_t* const row : rows) inside += row[x] + row[x + 1];
                if (inside == 0 || inside == 8) continue;
                std::array<std::size_t, 8> nodes;
                std::array<dvec3, 8> places;
                std::array<double, 8> values;
                for (std::size_t corner = 0; corner < 8; ++corner) {
                    const Node node{x + static_cast<int>(corner & 1), y + static_cast<int>(corner >> 1 & 1),
                                    z + static_cast<int>(corner >> 2)};
                    nodes[corner] = index(node);
                    places[corner] = place(node);
                    const double value = this->value(node),
                                 size = std::clamp(std::abs(value), kNearest * cell_, kFarthest * cell_);
                    values[corner] = value < 0 ? -size : size;
                }
                surface.addCell(nodes, places, values);
            }
        }
    return std::move(surface.mesh);
}

}  // namespace fantascope::theatre
