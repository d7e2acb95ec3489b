#include "pattern/search/silhouette.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <utility>

namespace fantascope::pattern {
namespace {

// The first pixel whose centre is at or right of (below) `edge`, clamped to 0 .. size.
int firstPixel(double edge, int size) {
    const double first = edge - 0.5;
    if (first <= 0) return 0;
    if (first >= size) return size;
    const int whole = static_cast<int>(first);
    return whole + (first > whole ? 1 : 0);
}

// The corners of a flat convex mesh's outline, anticlockwise as seen from +z; empty for any other
// mesh.
std::vector<std::uint32_t> convexOutlineOf(const TriangleMesh& mesh) {
    std::map<std::uint32_t, std::uint32_t> next;  // along the edges that belong to one triangle only
    std::set<std::pair<std::uint32_t, std::uint32_t>> directed;
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::dvec3 a = mesh.vertices[t.x], b = mesh.vertices[t.y], c = mesh.vertices[t.z];
        if (a.z != b.z || b.z != c.z || glm::cross(b - a, c - a).z <= 0) return {};
        for (int corner = 0; corner < 3; ++corner)
            if (!directed.emplace(t[corner], t[(corner + 1) % 3]).second) return {};
    }
    for (const auto& [from, to] : directed)
        if (!directed.contains({to, from}) && !next.emplace(from, to).second) return {};
    std::vector<std::uint32_t> outline;
    if (next.empty()) return {};
    std::uint32_t corner = next.begin()->first;
    do {
        outline.push_back(corner);
        corner = next.at(corner);
    } while (corner != outline.front() && outline.size() <= next.size());
    if (outline.size() != next.size()) return {};  // a hole, or several pieces
    double turned = 0;
    for (std::size_t i = 0; i < outline.size(); ++i) {
        const auto point = [&](std::size_t k) { return glm::dvec2(mesh.vertices[outline[(i + k) % outline.size()]]); };
        const glm::dvec2 u = point(1) - point(0), v = point(2) - point(1);
        const double turn = std::atan2(u.x * v.y - u.y * v.x, glm::dot(u, v));
        if (turn < 0) return {};
        turned += turn;
    }
    return turned < 3 * std::numbers::pi ? outline : std::vector<std::uint32_t>{};  // it winds once
}

}  // namespace

Silhouette::Silhouette(const TriangleMesh& mesh)
    : vertices_(mesh.vertices.begin(), mesh.vertices.end()), triangles_(mesh.triangles) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<Side>> sidesOfEdges;
    for (std::uint32_t t = 0; t < triangles_.size(); ++t)
        for (int corner = 0; corner < 3; ++corner) {
            const std::uint32_t from = triangles_[t][corner], to = triangles_[t][(corner + 1) % 3];
            sidesOfEdges[std::minmax(from, to)].push_back({t, from < to ? 1 : -1});
        }
    for (const auto& [edge, sides] : sidesOfEdges) {
        const auto first = static_cast<std::uint32_t>(sides_.size());
        sides_.insert(sides_.end(), sides.begin(), sides.end());
        edges_.push_back({edge.first, edge.second, first, static_cast<std::uint32_t>(sides_.size())});
    }
    convexOutline_ = convexOutlineOf(mesh);
}

SilhouetteScanner::SilhouetteScanner(int width, int height)
    : width_(width),
      height_(height),
      rows_(static_cast<std::size_t>(height), -1),
      convexRows_(static_cast<std::size_t>(height)) {}

void SilhouetteScanner::project(const Silhouette& shape, const InstancePose& pose) {
    const glm::dmat3 pixelsFromShape = canvasFromShape(pose) * double(height_);
    const glm::dvec2 centre = pose.centre * double(height_);
    projected_.clear();
    for (const glm::dvec3& vertex : shape.vertices_) projected_.push_back(centre + glm::dvec2(pixelsFromShape * vertex));
}

// Calls cross(y, x) for each row that the edge crosses, with the first pixel whose centre is right
// of it. Edges are always computed from their upper to their lower end, so that edges with the same
// ends cross every row at the same pixel.
template <class Cross>
void SilhouetteScanner::followEdge(glm::dvec2 upper, glm::dvec2 lower, Cross cross) {
    const int top = firstPixel(upper.y, height_), bottom = firstPixel(lower.y, height_);
    if (top == bottom) return;
    top_ = std::min(top_, top);
    bottom_ = std::max(bottom_, bottom);
    const double slope = (lower.x - upper.x) / (lower.y - upper.y);
    // Fixed point in units of 2^-32 pixel, so that the next row takes one addition. A slope that
    // overflows belongs to an edge in one row, which needs none.
    constexpr double kOne = 0x1p32;
    auto x = static_cast<std::int64_t>((upper.x + (top + 0.5 - upper.y) * slope - 0.5) * kOne);
    const auto step = bottom - top > 1 ? static_cast<std::int64_t>(slope * kOne) : 0;
    for (int y = top; y < bottom; ++y, x += step)
        cross(y, static_cast<int>(std::clamp<std::int64_t>((x + 0xffffffff) >> 32, 0, width_)));  // rounded up
}

void SilhouetteScanner::followConvexOutline(const std::vector<std::uint32_t>& outline) {
    // The sign of the area says whether the shape is seen from behind, with its outline reversed.
    double doubledArea = 0;
    glm::dvec2 from = projected_[outline.back()];
    for (const std::uint32_t corner : outline) {
        const glm::dvec2 to = projected_[corner];
        doubledArea += from.x * to.y - from.y * to.x;
        from = to;
    }
    Row* rows = convexRows_.data();
    for (const std::uint32_t corner : outline) {
        const glm::dvec2 to = projected_[corner];
        const bool down = to.y > from.y;
        const glm::dvec2 upper = down ? from : to, lower = down ? to : from;
        // If the outline runs clockwise as seen, it runs down on the right.
        if (down == (doubledArea > 0))
            followEdge(upper, lower, [&](int y, int x) { rows[y].end = x; });
        else
            followEdge(upper, lower, [&](int y, int x) { rows[y].begin = x; });
        from = to;
    }
}

void SilhouetteScanner::followOutline(const Silhouette& shape) {
    facing_.clear();
    for (const glm::uvec3& t : shape.triangles_) {
        const glm::dvec2 u = projected_[t.y] - projected_[t.x], v = projected_[t.z] - projected_[t.x];
        const double turn = u.x * v.y - u.y * v.x;
        facing_.push_back(turn > 0 ? 1 : turn < 0 ? -1 : 0);
    }
    // Along a row, the number of layered triangles changes only at edges. It does not change at an
    // edge between two triangles that face the same way, so only the outline remains.
    crossingCount_ = 0;
    for (const Silhouette::Edge& edge : shape.edges_) {
        int weight = 0;
        for (std::uint32_t i = edge.firstSide; i < edge.sidesEnd; ++i)
            weight += facing_[shape.sides_[i].triangle] * shape.sides_[i].direction;
        if (weight == 0) continue;
        const glm::dvec2 from = projected_[edge.from], to = projected_[edge.to];
        const bool down = to.y >= from.y;
        if (down) weight = -weight;  // a clockwise outline runs up on the left
        followEdge(down ? from : to, down ? to : from, [&](int y, int x) {
            if (crossings_.size() == static_cast<std::size_t>(crossingCount_)) crossings_.resize(2 * crossings_.size() + 64);
            Crossing* crossings = crossings_.data();
            int* link = &rows_[static_cast<std::size_t>(y)];
            while (*link >= 0 && crossings[*link].x < x) link = &crossings[*link].next;
            crossings[crossingCount_] = {x, weight, *link};
            *link = crossingCount_++;
        });
    }
}

}  // namespace fantascope::pattern
