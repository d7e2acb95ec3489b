#include "theatre/body/mesh_distance.h"

#include "theatre/body/triangle.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace fantascope::theatre {
using glm::dvec3;

MeshDistance::MeshDistance(const TriangleMesh& mesh, double around) : around_(around) {
    dvec3 least(std::numeric_limits<double>::infinity()), most = -least;
    for (const glm::vec3& vertex : mesh.vertices) least = glm::min(least, dvec3(vertex)), most = glm::max(most, dvec3(vertex));
    least -= around, most += around;
    const dvec3 size = most - least;
    cell_ = std::max({size.x, size.y, size.z}) / kCells;
    least_ = least;
    std::size_t count = 1;
    for (int axis = 0; axis < 3; ++axis) {
        nodes_[static_cast<std::size_t>(axis)] = static_cast<int>(std::ceil(size[axis] / cell_)) + 1;
        count *= static_cast<std::size_t>(nodes_[static_cast<std::size_t>(axis)]);
    }
    values_.assign(count, std::numeric_limits<float>::max());
    measure(mesh);
    sign(mesh);
}

// Measures unsigned distances.
void MeshDistance::measure(const TriangleMesh& mesh) {
    std::vector<std::int32_t> nearest(values_.size(), -1);
    const auto corner = [&](std::int32_t triangle, int i) {
        return dvec3(mesh.vertices[mesh.triangles[static_cast<std::size_t>(triangle)][i]]);
    };
    const auto take = [&](std::size_t at, int x, int y, int z, std::int32_t triangle) {
        const dvec3 node = least_ + cell_ * dvec3(x, y, z);
        const auto distance = static_cast<float>(
            glm::distance(node, nearestOf(node, corner(triangle, 0), corner(triangle, 1), corner(triangle, 2))));
        if (distance < values_[at]) values_[at] = distance, nearest[at] = triangle;
    };
    // Exact distances around each triangle.
    for (std::int32_t triangle = 0; triangle < static_cast<std::int32_t>(mesh.triangles.size()); ++triangle) {
        const dvec3 a = corner(triangle, 0), b = corner(triangle, 1), c = corner(triangle, 2);
        const dvec3 low = (glm::min(glm::min(a, b), c) - least_) / cell_, high = (glm::max(glm::max(a, b), c) - least_) / cell_;
        int from[3], to[3];
        for (int i = 0; i < 3; ++i) {
            from[i] = std::max(0, static_cast<int>(std::floor(low[i])) - 1);
            to[i] = std::min(nodes_[static_cast<std::size_t>(i)] - 1, static_cast<int>(std::ceil(high[i])) + 1);
        }
        for (int z = from[2]; z <= to[2]; ++z)
            for (int y = from[1]; y <= to[1]; ++y)
                for (int x = from[0]; x <= to[0]; ++x) take(index(x, y, z), x, y, z, triangle);
    }
    // Then the nearest triangles propagate from node to node, in two rounds of the eight sweep
    // directions.
    for (int pass = 0; pass < 16; ++pass) {
        const int sx = (pass & 1) != 0 ? 1 : -1, sy = (pass & 2) != 0 ? 1 : -1, sz = (pass & 4) != 0 ? 1 : -1;
        const auto first = [](int step, int nodes) { return step > 0 ? 1 : nodes - 2; };
        const auto isIn = [](int i, int nodes) { return i >= 0 && i < nodes; };
        for (int z = first(sz, nodes_[2]); isIn(z, nodes_[2]); z += sz)
            for (int y = first(sy, nodes_[1]); isIn(y, nodes_[1]); y += sy)
                for (int x = first(sx, nodes_[0]); isIn(x, nodes_[0]); x += sx) {
                    const std::size_t at = index(x, y, z);
                    for (int from = 1; from < 8; ++from) {
                        const std::int32_t triangle = nearest[index(
                            x - ((from & 1) != 0 ? sx : 0), y - ((from & 2) != 0 ? sy : 0), z - ((from & 4) != 0 ? sz : 0))];
                        if (triangle >= 0 && triangle != nearest[at]) take(at, x, y, z, triangle);
                    }
                }
    }
}

void MeshDistance::sign(const TriangleMesh& mesh) {
    std::vector<std::uint8_t> votes(values_.size(), 0), crossings(values_.size());
    for (int axis = 0; axis < 3; ++axis) {
        // For each grid line along the axis: how many triangles cross it before each node.
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        std::fill(crossings.begin(), crossings.end(), std::uint8_t{0});
        const auto nodesOf = [&](int i) { return nodes_[static_cast<std::size_t>(i)]; };
        const auto at = [&](int along, int i, int j) {
            int place[3];
            place[axis] = along, place[u] = i, place[v] = j;
            return index(place[0], place[1], place[2]);
        };
        for (const glm::uvec3& triangle : mesh.triangles) {
            dvec3 corners[3];
            for (int i = 0; i < 3; ++i) corners[i] = (dvec3(mesh.vertices[triangle[i]]) - least_) / cell_;
            const dvec3 low = glm::min(glm::min(corners[0], corners[1]), corners[2]),
                        high = glm::max(glm::max(corners[0], corners[1]), corners[2]);
            for (int j = std::max(0, static_cast<int>(std::ceil(low[v])));
                 j <= std::min(nodesOf(v) - 1, static_cast<int>(high[v])); ++j)
                for (int i = std::max(0, static_cast<int>(std::ceil(low[u])));
                     i <= std::min(nodesOf(u) - 1, static_cast<int>(high[u])); ++i) {
                    glm::dvec2 flat[3];
                    for (int k = 0; k < 3; ++k) flat[k] = {corners[k][u] - i, corners[k][v] - j};
                    const int side = sideOf(flat[1], flat[2]);
                    if (side == 0 || sideOf(flat[2], flat[0]) != side || sideOf(flat[0], flat[1]) != side) continue;
                    double shares[3], all = 0, along = 0;
                    for (int k = 0; k < 3; ++k) {
                        const glm::dvec2 a = flat[(k + 1) % 3], b = flat[(k + 2) % 3];
                        all += shares[k] = a.y * b.x - a.x * b.y;
                    }
                    if (all == 0) continue;
                    for (int k = 0; k < 3; ++k) along += shares[k] / all * corners[k][axis];
                    const int before = std::max(0, static_cast<int>(std::ceil(along)));
                    if (before < nodesOf(axis)) crossings[at(before, i, j)] ^= 1;
                }
        }
        for (int j = 0; j < nodesOf(v); ++j)
            for (int i = 0; i < nodesOf(u); ++i) {
                std::uint8_t inside = 0;
                for (int along = 0; along < nodesOf(axis); ++along)
                    votes[at(along, i, j)] =
                        static_cast<std::uint8_t>(votes[at(along, i, j)] + (inside ^= crossings[at(along, i, j)]));
            }
    }
    for (std::size_t i = 0; i < values_.size(); ++i)
        if (votes[i] >= 2) values_[i] = -values_[i];
}

double MeshDistance::at(const dvec3& point, dvec3& outward) const {
    const dvec3 last(nodes_[0] - 1, nodes_[1] - 1, nodes_[2] - 1);
    const dvec3 wanted = (point - least_) / cell_, place = glm::clamp(wanted, dvec3(0), last);
    const dvec3 beyond = cell_ * (wanted - place);
    if (const double distance = glm::length(beyond); distance > 0) {
        outward = beyond / distance;
        return around_ + distance;
    }
    int node[3];
    double share[3];
    for (int i = 0; i < 3; ++i) {
        node[i] = std::min(static_cast<int>(place[i]), nodes_[static_cast<std::size_t>(i)] - 2);
        share[i] = place[i] - node[i];
    }
    double value = 0;
    dvec3 gradient(0);
    for (int corner = 0; corner < 8; ++corner) {
        const bool far[3] = {(corner & 1) != 0, (corner & 2) != 0, (corner & 4) != 0};
        const double at = values_[index(node[0] + far[0], node[1] + far[1], node[2] + far[2])];
        double weights[3];
        for (int i = 0; i < 3; ++i) weights[i] = far[i] ? share[i] : 1 - share[i];
        value += weights[0] * weights[1] * weights[2] * at;
        for (int i = 0; i < 3; ++i) gradient[i] += (far[i] ? at : -at) * weights[(i + 1) % 3] * weights[(i + 2) % 3];
    }
    const double slope = glm::length(gradient);
    outward = slope > 0 ? gradient / slope : dvec3(0, 1, 0);
    return value;
}

}  // namespace fantascope::theatre
