#include "pattern/silhouette.h"

#include <algorithm>
#include <map>
#include <utility>

namespace fantascope::pattern {
namespace {

// The first pixel whose centre is at or right of (below) `edge`, cut to 0 .. size.
int firstPixel(double edge, int size) {
    const double first = edge - 0.5;
    if (first <= 0) return 0;
    if (first >= size) return size;
    const int whole = static_cast<int>(first);
    return whole + (first > whole ? 1 : 0);
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
}

SilhouetteScanner::SilhouetteScanner(int width, int height)
    : width_(width), height_(height), rows_(static_cast<std::size_t>(height), -1) {}

void SilhouetteScanner::followOutline(const Silhouette& shape, const InstancePose& pose) {
    const glm::dmat3 pixelsFromShape = canvasFromShape(pose) * double(height_);
    const glm::dvec2 centre = pose.centre * double(height_);
    projected_.clear();
    for (const glm::dvec3& vertex : shape.vertices_) projected_.push_back(centre + glm::dvec2(pixelsFromShape * vertex));
    facing_.clear();
    for (const glm::uvec3& t : shape.triangles_) {
        const glm::dvec2 u = projected_[t.y] - projected_[t.x], v = projected_[t.z] - projected_[t.x];
        const double turn = u.x * v.y - u.y * v.x;
        facing_.push_back(turn > 0 ? 1 : turn < 0 ? -1 : 0);
    }
    // Along a row, the number of triangles above each other changes at edges only, and at an edge between two triangles that face
    // the same way it does not change either: what remains is the outline.
    crossingCount_ = 0;
    top_ = height_, bottom_ = 0;
    for (const Silhouette::Edge& edge : shape.edges_) {
        int weight = 0;
        for (std::uint32_t i = edge.firstSide; i < edge.sidesEnd; ++i)
            weight += facing_[shape.sides_[i].triangle] * shape.sides_[i].direction;
        if (weight != 0) addEdge(projected_[edge.from], projected_[edge.to], weight);
    }
}

void SilhouetteScanner::addEdge(glm::dvec2 from, glm::dvec2 to, int weight) {
    // Always computed from the upper to the lower end, so that edges with the same ends cross every row at the same pixel.
    if (to.y < from.y)
        std::swap(from, to);
    else
        weight = -weight;  // clockwise, the way up is on the left
    const int top = firstPixel(from.y, height_), bottom = firstPixel(to.y, height_);
    if (top == bottom) return;
    top_ = std::min(top_, top);
    bottom_ = std::max(bottom_, bottom);
    const double slope = (to.x - from.x) / (to.y - from.y);
    // In steps of 2^-32 pixel; from one row to the next is an addition. A slope that does not fit belongs to an edge of one row.
    constexpr double kOne = 0x1p32;
    auto x = static_cast<std::int64_t>((from.x + (top + 0.5 - from.y) * slope - 0.5) * kOne);
    const auto step = bottom - top > 1 ? static_cast<std::int64_t>(slope * kOne) : 0;
    const auto needed = static_cast<std::size_t>(crossingCount_ + bottom - top);
    if (crossings_.size() < needed) crossings_.resize(2 * needed);
    Crossing* crossings = crossings_.data();
    for (int y = top; y < bottom; ++y, x += step) {
        const int pixel = static_cast<int>(std::clamp<std::int64_t>((x + 0xffffffff) >> 32, 0, width_));  // rounded up
        int* link = &rows_[static_cast<std::size_t>(y)];
        while (*link >= 0 && crossings[*link].x < pixel) link = &crossings[*link].next;
        crossings[crossingCount_] = {pixel, weight, *link};
        *link = crossingCount_++;
    }
}

}  // namespace fantascope::pattern
