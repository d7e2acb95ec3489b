#include "theatre/body/implicit_surface.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <unordered_map>

namespace fantascope::theatre {
namespace {

constexpr std::size_t kBlock = 4;  // cells along a side of a block; a block far from the surface is skipped as a whole

// The corners of a cell are numbered by their bits: 1 is a step along x, 2 along y, 4 along z. Each
// tetrahedron goes from corner 0 to corner 7 by one step along each axis, and is right-handed.
constexpr std::array<std::array<unsigned, 4>, 6> kTetrahedra = {
    {{0, 1, 3, 7}, {0, 5, 1, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 4, 5, 7}, {0, 6, 4, 7}}};
// Even permutations of a tetrahedron's corners, which keep its orientation. They put first the
// corner that lies alone on its side of the surface, or the two corners that lie inside.
constexpr std::array<std::array<unsigned, 4>, 4> kAroundOne = {{{0, 1, 2, 3}, {1, 0, 3, 2}, {2, 3, 0, 1}, {3, 2, 1, 0}}};
constexpr std::array<std::array<unsigned, 4>, 6> kAroundTwo = {
    {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2}, {1, 2, 0, 3}, {1, 3, 2, 0}, {2, 3, 0, 1}}};

class Marcher {
public:
    Marcher(const std::function<double(const glm::dvec3&)>& field, const GridPlanes& planes, double slack)
        : field_(field), planes_(planes), slack_(slack) {
        for (std::size_t i = 0; i < 3; ++i) count_[i] = planes[i].size();
        values_.assign(count_[0] * count_[1] * count_[2], std::numeric_limits<double>::quiet_NaN());
    }

    TriangleMesh march() {
        for (std::size_t z = 0; z + 1 < count_[2]; z += kBlock)
            for (std::size_t y = 0; y + 1 < count_[1]; y += kBlock)
                for (std::size_t x = 0; x + 1 < count_[0]; x += kBlock) block({x, y, z});
        return std::move(surface_.mesh);
    }

private:
    using Node = std::array<std::size_t, 3>;

    glm::dvec3 place(const Node& node) const { return {planes_[0][node[0]], planes_[1][node[1]], planes_[2][node[2]]}; }
    std::size_t index(const Node& node) const { return (node[2] * count_[1] + node[1]) * count_[0] + node[0]; }
    double value(const Node& node) {
        double& value = values_[index(node)];
        if (value != value) value = field_(place(node));
        return value;
    }

    void block(const Node& from) {
        Node to;
        for (std::size_t i = 0; i < 3; ++i) to[i] = std::min(from[i] + kBlock, count_[i] - 1);
        const glm::dvec3 low = place(from), high = place(to);
        if (std::abs(field_(0.5 * (low + high))) > slack_ * 0.5 * glm::distance(low, high)) return;
        for (std::size_t z = from[2]; z < to[2]; ++z)
            for (std::size_t y = from[1]; y < to[1]; ++y)
                for (std::size_t x = from[0]; x < to[0]; ++x) cell({x, y, z});
    }

    void cell(const Node& at) {
        std::array<Node, 8> nodes;
        std::array<double, 8> values;
        unsigned inside = 0;
        for (unsigned corner = 0; corner < 8; ++corner) {
            nodes[corner] = {at[0] + (corner & 1), at[1] + (corner >> 1 & 1), at[2] + (corner >> 2)};
            values[corner] = value(nodes[corner]);
            inside += values[corner] < 0;
        }
        if (inside == 0 || inside == 8) return;
        std::array<std::size_t, 8> indices;
        std::array<glm::dvec3, 8> places;
        for (std::size_t i = 0; i < 8; ++i) indices[i] = index(nodes[i]), places[i] = place(nodes[i]);
        surface_.addCell(indices, places, values);
    }

    const std::function<double(const glm::dvec3&)>& field_;
    const GridPlanes& planes_;
    double slack_;
    Node count_{};
    std::vector<double> values_;  // of the nodes; NaN if not evaluated yet
    TetrahedraSurface surface_;
};

}  // namespace

void TetrahedraSurface::addCell(const std::array<std::size_t, 8>& nodes, const std::array<glm::dvec3, 8>& places,
                                const std::array<double, 8>& values) {
    // The vertex where the surface crosses the edge between two corners.
    const auto crossing = [&](unsigned a, unsigned b) {
        if (a > b) std::swap(a, b);
        const auto [found, isNew] =
            crossings_.try_emplace(nodes[a] * 8 + (b - a), static_cast<std::uint32_t>(mesh.vertices.size()));
        if (isNew) mesh.vertices.emplace_back(glm::mix(places[a], places[b], values[a] / (values[a] - values[b])));
        return found->second;
    };
    for (const auto& corners : kTetrahedra) {
        unsigned within = 0;
        for (unsigned i = 0; i < 4; ++i) within |= static_cast<unsigned>(values[corners[i]] < 0) << i;
        const auto add = [&](const std::array<unsigned, 4>& order, bool isTurned) {
            const auto at = [&](unsigned a, unsigned b) { return crossing(corners[order[a]], corners[order[b]]); };
            const std::uint32_t first = at(0, 1), second = at(0, 2), third = at(0, 3);
            mesh.triangles.push_back(isTurned ? glm::uvec3(first, third, second) : glm::uvec3(first, second, third));
        };
        for (unsigned i = 0; i < 4; ++i) {
            if (within == 1u << i) add(kAroundOne[i], false);
            if (within == (15u ^ 1u << i)) add(kAroundOne[i], true);
        }
        for (const auto& order : kAroundTwo) {
            if (within != (1u << order[0] | 1u << order[1])) continue;
            const auto at = [&](unsigned a, unsigned b) { return crossing(corners[order[a]], corners[order[b]]); };
            const std::uint32_t first = at(0, 2), second = at(0, 3), third = at(1, 3), fourth = at(1, 2);
            mesh.triangles.emplace_back(first, second, third);
            mesh.triangles.emplace_back(first, third, fourth);
        }
    }
}

TriangleMesh implicitSurface(const std::function<double(const glm::dvec3&)>& field, const GridPlanes& planes, double slack) {
    return Marcher(field, planes, slack).march();
}

}  // namespace fantascope::theatre
