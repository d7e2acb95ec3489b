#include "theatre/mesh_shadow.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace fantascope::theatre {

bool MeshShadow::add(const ScreenFrame& frame, const BodyMesh& mesh, std::span<const glm::vec3> vertices, BitMask& mask) {
    // Nearer to the light's height than this a shadow is as good as unbounded, metres.
    constexpr float kNearest = 1e-3f;
    const std::size_t count = vertices.size();
    x_.resize(count), y_.resize(count);
    const glm::vec3 light(-frame.fromLight({0, 0, 0}).x, frame.fromLight({0, 0, 0}).y, frame.fromLight({0, 0, 0}).z);
    const glm::vec2 foot = frame.foot();
    const auto focus = static_cast<float>(frame.focus());
    float nearest = light.z;
    for (std::size_t i = 0; i < count; ++i) {
        const float z = light.z - vertices[i].z, scale = focus / z;
        nearest = std::min(nearest, z);
        x_[i] = foot.x + scale * (vertices[i].x - light.x);
        y_[i] = foot.y + scale * (light.y - vertices[i].y);
    }
    if (nearest < kNearest) return false;

    const std::vector<glm::uvec3>& triangles = mesh.atRest.triangles;
    faces_.resize(triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        const glm::uvec3& c = triangles[t];
        const float ax = x_[c.x], ay = y_[c.x];
        // Rows go down: anticlockwise is negative.
        faces_[t] = (x_[c.y] - ax) * (y_[c.z] - ay) - (x_[c.z] - ax) * (y_[c.y] - ay) < 0;
    }
    crossings_.clear();
    for (const MeshEdge& edge : mesh.edges) {
        if (faces_[edge.left] == faces_[edge.right]) continue;
        cross({x_[edge.from], y_[edge.from]}, {x_[edge.to], y_[edge.to]}, faces_[edge.left] != 0 ? 1 : -1, mask);
    }

    // By rows, then within each from the left.
    rows_.assign(static_cast<std::size_t>(mask.height()), 0);
    for (const Crossing& crossing : crossings_) ++rows_[static_cast<std::size_t>(crossing.row)];
    std::uint32_t before = 0;
    for (std::uint32_t& row : rows_) before += std::exchange(row, before);
    sorted_.resize(crossings_.size());
    for (const Crossing& crossing : crossings_) {
        std::uint32_t& end = rows_[static_cast<std::size_t>(crossing.row)];
        sorted_[end++] = crossing;
    }
    std::size_t first = 0;
    for (int row = 0; row < mask.height(); ++row) {
        const std::size_t end = rows_[static_cast<std::size_t>(row)];
        std::sort(sorted_.begin() + static_cast<std::ptrdiff_t>(first), sorted_.begin() + static_cast<std::ptrdiff_t>(end),
                  [](const Crossing& a, const Crossing& b) { return a.column < b.column; });
        int winding = 0, from = 0;
        for (; first < end; ++first) {
            const int wound = winding;
            winding += sorted_[first].turn;
            if (wound == 0)
                from = sorted_[first].column;
            else if (winding == 0)
                mask.fill(row, from, sorted_[first].column);
        }
    }
    return true;
}

// The rows whose centres lie between the ends, that at the upper end included, that at the lower not, so that an outline crosses
// a row as often down as up.
void MeshShadow::cross(glm::vec2 a, glm::vec2 b, int turn, const BitMask& mask) {
    if (a.y > b.y) std::swap(a, b), turn = -turn;
    const auto width = static_cast<float>(mask.width()), height = static_cast<float>(mask.height());
    const int from = static_cast<int>(std::ceil(std::clamp(a.y - 0.5f, 0.0f, height)));
    const int to = static_cast<int>(std::ceil(std::clamp(b.y - 0.5f, 0.0f, height)));
    if (from >= to) return;
    const float slope = (b.x - a.x) / (b.y - a.y);
    for (int row = from; row < to; ++row) {
        const float x = a.x + (static_cast<float>(row) + 0.5f - a.y) * slope;
        crossings_.push_back({row, static_cast<std::int32_t>(std::ceil(std::clamp(x - 0.5f, 0.0f, width))), turn});
    }
}

}  // namespace fantascope::theatre
